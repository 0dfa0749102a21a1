// The scope: which signals, what is kept, when it is taken.
import { control } from '../control/control.svelte';
import { drawn, type Drawn } from './draw';
import { frameOf } from './frame';
import { SampleRecord } from './record';
import { triggerRow, type Edge } from './trigger';

const most_s = 30;
const most_points = 1600;
export type State = 'off' | 'runs' | 'waits' | 'taken';

class Scope {
  signals = $state<string[]>([]);
  state = $state<State>('off');
  span_s = $state(2);
  pretrigger_percent = $state(20);
  edge = $state<Edge>('begins');
  level = $state(0);
  triggerSignal = $state('');
  trace = $state.raw<Drawn>({ times: [], traces: [] });
  from = $state(0);
  to = $state(0);
  lost = $state(0);
  /** Machine time of the trigger; null: none. */
  trigger_s = $state<number | null>(null);
  record = $state.raw<SampleRecord | null>(null);
  #searched_s = 0;
  #drawn_ms = 0;
  #stop: (() => void) | null = null;

  /** Runs freely, or waits for the trigger. */
  run(waits: boolean): void {
    this.#stop?.();
    this.record = null;
    this.trigger_s = null;
    this.#searched_s = 0;
    this.lost = 0;
    this.state = waits ? 'waits' : 'runs';
    control.tell({ type: 'scope', signals: this.signals });
    const ends = [
      control.onScope((data) => this.#take(data)),
      control.on((message) => { if (message.type === 'event' && message.event === 'alarm') this.alarm(Number(message.time_s)); }),
    ];
    this.#stop = () => ends.forEach((end) => end());
  }

  stop(): void {
    control.tell({ type: 'scope', signals: [] });
    this.#stop?.();
    this.#stop = null;
    if (this.state !== 'off') this.state = this.record ? 'taken' : 'off';
  }

  /** An alarm has come at this machine time. */
  alarm(time_s: number): void {
    if (this.state === 'waits' && this.edge === 'alarm') this.trigger_s ??= time_s;
  }

  #take(data: ArrayBuffer): void {
    const frame = frameOf(data);
    if (!frame || frame.signals.join() !== this.signals.join()) return;
    this.record ??= new SampleRecord(frame.signals, frame.period_s, Math.ceil(most_s / frame.period_s));
    this.record.add(frame);
    this.lost = this.record.lost;
    if (this.state === 'waits') this.#search(this.record);
    const now = performance.now();
    if (this.state !== 'taken' && now - this.#drawn_ms < 80) return;
    this.#drawn_ms = now;
    this.draw();
  }

  #search(record: SampleRecord): void {
    const signal = Math.max(0, record.signals.indexOf(this.triggerSignal));
    const before_s = (this.span_s * this.pretrigger_percent) / 100;
    if (this.trigger_s === null) {
      const from = Math.max(record.rowAt(this.#searched_s), 1);
      const row = triggerRow(record.column(signal), from, { signal, edge: this.edge, level: this.level });
      this.#searched_s = record.end_s;
      if (row !== null) this.trigger_s = record.start_s + row * record.period_s;
    }
    if (this.trigger_s !== null && record.end_s >= this.trigger_s + this.span_s - before_s) this.stop();
  }

  /** The moment at 0 of the time axis: the trigger, or now. */
  get zero_s(): number {
    return this.trigger_s ?? this.record?.end_s ?? 0;
  }

  draw(): void {
    const record = this.record;
    if (!record) return;
    const { zero_s } = this;
    const before_s = this.trigger_s === null ? this.span_s : (this.span_s * this.pretrigger_percent) / 100;
    this.from = -before_s;
    this.to = this.span_s - before_s;
    this.trace = drawn(record, zero_s + this.from, zero_s + this.to, zero_s, most_points);
  }
}

export const scope = new Scope();
