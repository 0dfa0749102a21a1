// The samples that the scope keeps: the newest of each signal, up to a limit, on one time axis.
import type { Frame } from './frame';

export class SampleRecord {
  readonly signals: string[];
  readonly period_s: number;
  lost = 0;
  #columns: Float32Array[];
  #start_s = 0;
  #rows = 0;

  constructor(signals: string[], period_s: number, readonly most_rows: number) {
    this.signals = signals;
    this.period_s = period_s;
    this.#columns = signals.map(() => new Float32Array(most_rows * 2));
  }

  get rows(): number { return this.#rows; }
  get start_s(): number { return this.#start_s; }
  get end_s(): number { return this.#start_s + this.#rows * this.period_s; }

  /** A frame that does not follow the last one begins anew: no trace is drawn across a gap. */
  add(frame: Frame): void {
    const isNext = Math.abs(frame.start_s - this.end_s) < this.period_s / 2;
    if (this.#rows > 0 && !isNext) this.clear();
    if (this.#rows === 0) this.#start_s = frame.start_s;
    this.lost += frame.lost_rows;
    if (this.#rows + frame.rows > this.most_rows * 2) this.#keepNewest(this.most_rows);
    frame.columns.forEach((column, index) => this.#columns[index]?.set(column.subarray(0, this.most_rows), this.#rows));
    this.#rows += Math.min(frame.rows, this.most_rows);
  }

  #keepNewest(rows: number): void {
    const drop = Math.max(0, this.#rows - rows);
    for (const column of this.#columns) column.copyWithin(0, drop, this.#rows);
    this.#rows -= drop;
    this.#start_s += drop * this.period_s;
  }

  clear(): void {
    this.#rows = 0;
  }

  column(signal: number): Float32Array {
    return this.#columns[signal]?.subarray(0, this.#rows) ?? new Float32Array(0);
  }

  rowAt(time_s: number): number {
    return Math.round((time_s - this.#start_s) / this.period_s);
  }
}
