// What was measured along the path: feed and sync error of each of its pairs, from the run as the page saw it.
import type { Sample } from '../control/trace.svelte';
import { progress, type PathArrays } from './path';

export class Measured {
  /** mm/min; NaN: not measured. */
  readonly feed: Float32Array;
  /** µm, the largest in magnitude; NaN: not measured. */
  readonly sync: Float32Array;
  /** The pair that is executed. */
  done = 0;
  /** The pair that was executed at each sample. */
  readonly doneAt: number[] = [];
  /** A line that has no pair any more: it is not searched for with each sample. */
  #missing = 0;
  #next = 0;

  constructor(readonly path: PathArrays) {
    this.feed = new Float32Array(path.lines.length).fill(NaN);
    this.sync = new Float32Array(path.lines.length).fill(NaN);
  }

  /** Takes the samples that have come since; true: there were some. */
  take(samples: readonly Sample[]): boolean {
    const from = this.#next;
    for (; this.#next < samples.length; this.#next++) {
      const sample = samples[this.#next];
      if (sample) this.#add(sample);
      this.doneAt.push(this.done);
    }
    return this.#next > from;
  }

  #add(sample: Sample): void {
    const before = this.done;
    if (sample.line > 0 && sample.line !== this.#missing) {
      this.done = progress(this.path, before, sample.line, sample.at);
      this.#missing = this.path.lines[this.done] === sample.line ? 0 : sample.line;
    }
    if (this.path.lines.length === 0) return;
    // Pairs shorter than the way between two statuses have the speed of this way; where the tool stands nothing is measured.
    for (let pair = Math.min(before + 1, this.done); pair <= this.done; pair++) {
      if (sample.feed > 0) this.feed[pair] = sample.feed;
      const error = sample.sync_um;
      const known = this.sync[pair] ?? NaN;
      if (error !== null && !(Math.abs(known) >= Math.abs(error))) this.sync[pair] = error;
    }
  }
}
