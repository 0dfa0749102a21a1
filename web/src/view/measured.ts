// What was measured along the path: feed and sync error of each of its pairs, from the run as the page saw it.
import type { Sample } from '../control/trace.svelte';
import { progress, type PathArrays } from './path';

/** What an axis that stands may seem to move from one status to the next, mm. */
const least_way = 0.005;

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
  #last: Sample | null = null;
  /** The longest way of each pair that was gone with one speed, mm: the pair's feed is this speed. */
  readonly #way: Float32Array;

  constructor(readonly path: PathArrays) {
    this.feed = new Float32Array(path.lines.length).fill(NaN);
    this.sync = new Float32Array(path.lines.length).fill(NaN);
    this.#way = new Float32Array(path.lines.length);
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
    const motion = this.#motionTo(sample);
    this.#last = sample;
    if (sample.line > 0 && sample.line !== this.#missing) {
      this.done = progress(this.path, before, sample.line, sample.at, motion.moved);
      this.#missing = this.path.lines[this.done] === sample.line ? 0 : sample.line;
    }
    if (this.path.lines.length === 0) return;
    // Pairs shorter than the way between two statuses have the speed of this way; where the tool stands nothing is measured.
    for (let pair = Math.min(before + 1, this.done); pair <= this.done; pair++) {
      // What was gone before the pair was gone with another speed.
      const way = Math.min(motion.way, this.#wayInto(pair, sample.at));
      if (sample.feed > 0 && way >= (this.#way[pair] ?? 0)) {
        this.feed[pair] = sample.feed;
        this.#way[pair] = way;
      }
      const error = sample.sync_um;
      const known = this.sync[pair] ?? NaN;
      if (error !== null && !(Math.abs(known) >= Math.abs(error))) this.sync[pair] = error;
    }
  }

  #wayInto(pair: number, at: readonly number[]): number {
    return Math.hypot(...at.map((value, axis) => value - (this.path.points[pair * 6 + axis] ?? value)));
  }

  /** Where to and how far the tool went since the last sample, mm. What is farther than its speed allows is an offset that came into force. */
  #motionTo(sample: Sample): { moved: number[]; way: number } {
    const last = this.#last ?? sample;
    const moved = sample.at.map((at, axis) => at - (last.at[axis] ?? at));
    const way = Math.min(Math.hypot(...moved), (Math.max(sample.feed, last.feed) / 60) * (sample.time_s - last.time_s));
    return { moved: way > least_way ? moved : [0, 0, 0], way };
  }
}
