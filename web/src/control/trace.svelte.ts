// The run as this page saw it: place, line and sync error of each status since the program was started.
import { control, type ServerMessage } from './control.svelte';
import type { Status } from './model';
import { isUnderWay } from './needs';

/** `feed`: speed of the path, mm/min. */
export interface Sample { time_s: number; at: [number, number, number]; line: number; feed: number; sync_um: number | null }

/** An hour at 50 Hz; of a longer run every second status is given up, then every second of these, and so on. */
const most_samples = 180_000;

export class RunTrace {
  samples: Sample[] = [];
  /** Grows when samples that were there before are gone. */
  version = $state(0);
  count = $state(0);
  program = $state<string | null>(null);
  #wasUnderWay = false;
  #every = 1;
  #skipped = 0;

  take(status: Status): void {
    const isOfProgram = status.program !== null && status.program.name !== 'MDI';
    const isNow = isOfProgram && isUnderWay(status);
    const hasBegun = isNow && !this.#wasUnderWay;
    const isOther = status.time_s < (this.samples.at(-1)?.time_s ?? 0);
    if (hasBegun || isOther) this.#begin(status.program?.name ?? null);
    // The status after the last motion belongs to the run as well.
    if (isNow || this.#wasUnderWay) this.#add(status);
    this.#wasUnderWay = isNow;
  }

  #begin(program: string | null): void {
    this.samples = [];
    this.program = program;
    this.#every = 1;
    this.version += 1;
    this.count = 0;
  }

  #add(status: Status): void {
    const place = (letter: string) => status.axes.find((axis) => axis.letter === letter)?.work ?? 0;
    const sample: Sample = { time_s: status.time_s, at: [place('X'), place('Y'), place('Z')], line: status.program?.line ?? 0, feed: status.path_mm_per_min, sync_um: status.sync_error_um };
    const last = this.samples.at(-1);
    if (last && (last.time_s === sample.time_s || this.#skipped + 1 < this.#every)) {
      this.#skipped += 1;
      last.sync_um = larger(last.sync_um, sample.sync_um);
      return;
    }
    this.#skipped = 0;
    this.samples.push(sample);
    if (this.samples.length >= most_samples) this.#thin();
    this.count = this.samples.length;
  }

  #thin(): void {
    this.samples = this.samples.filter((sample, index) => {
      const next = this.samples[index + 1];
      if (index % 2 === 0 && next) sample.sync_um = larger(sample.sync_um, next.sync_um);
      return index % 2 === 0;
    });
    this.#every *= 2;
    this.version += 1;
  }
}

function larger(a: number | null, b: number | null): number | null {
  if (a === null || b === null) return a ?? b;
  return Math.abs(b) > Math.abs(a) ? b : a;
}

export const trace = new RunTrace();
/** Each status of the control goes into it. */
export function follow(message: ServerMessage): void {
  if ((message.type === 'status' || message.type === 'delta') && control.status) trace.take(control.status);
}
