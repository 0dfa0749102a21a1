// Alarms, present and past, as the control keeps them.
import { get } from './api';
import { control } from './control.svelte';
import type { Alarm } from './model';

class Alarms {
  all = $state.raw<Alarm[]>([]);

  async load(): Promise<void> {
    try {
      this.all = await get<Alarm[]>('/alarms');
    } catch {
      // The bar says that there is no connection.
    }
  }

  /** The alarm that stops the machine now; its text is that of the status, its remedy that of the list. */
  get current(): { text: string; remedy: string | null } | null {
    const text = control.status?.alarms[0];
    if (text === undefined) return null;
    return { text, remedy: this.all.find((alarm) => alarm.text === text && !alarm.is_cleared)?.remedy ?? null };
  }
}

export const alarms = new Alarms();
