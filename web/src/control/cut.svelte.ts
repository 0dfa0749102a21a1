// What the workpiece has so far, feature by feature, and the largest sync error since a tool went into the work.
import { get } from './api';
import { mapOf, shiftOf } from './holes';
import { loaded } from './program.svelte';
import type { Feature } from './model';
import { control, type ServerMessage } from './control.svelte';

class Cut {
  features = $state.raw<Feature[]>([]);
  /** The shift from machine to work coordinates; equal pairs are one, so that the map is made anew only when it moves. */
  #shiftText = $derived(shiftOf(control.status?.axes ?? []).join(' '));
  map = $derived(mapOf(loaded.program?.holes ?? [], this.features, this.#shiftText.split(' ').map(Number) as [number, number]));
  worst_um = $state<number | null>(null);
  last = $state<string | null>(null);
  #wasCoupled = false;

  async load(): Promise<void> {
    try {
      this.features = await get<Feature[]>('/features');
    } catch {
      // The bar says that there is no connection.
    }
  }

  take(message: ServerMessage): void {
    const error = control.status?.sync_error_um ?? null;
    if (error !== null) {
      if (!this.#wasCoupled) this.worst_um = null;
      if (this.worst_um === null || Math.abs(error) > Math.abs(this.worst_um)) this.worst_um = error;
    }
    this.#wasCoupled = error !== null;
    if (message.type === 'event' && message.event === 'feature') this.last = String(message.text);
  }
}

export const cut = new Cut();
