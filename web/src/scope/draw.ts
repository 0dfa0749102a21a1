// What is drawn of a record: no more points than the picture can show, with the least and the largest of each group kept.
import type { SampleRecord } from './record';

export interface Drawn { times: number[]; traces: (number | null)[][] }

export function drawn(record: SampleRecord, from_s: number, to_s: number, zero_s: number, most_points: number): Drawn {
  const first = Math.max(0, record.rowAt(from_s));
  const end = Math.min(record.rows, record.rowAt(to_s) + 1);
  const group = Math.max(1, Math.ceil((end - first) / most_points) * 2);
  const times: number[] = [];
  const columns = record.signals.map((_, index) => record.column(index));
  const traces = columns.map((): (number | null)[] => []);
  for (let row = first; row < end; row += group) {
    const to = Math.min(end, row + group);
    const half = group > 1 ? 2 : 1;
    for (let k = 0; k < half; k++) times.push(record.start_s - zero_s + (row + (k * group) / 2) * record.period_s);
    columns.forEach((column, index) => {
      const [least, most, isLeastFirst] = extremes(column, row, to);
      const trace = traces[index];
      if (half === 1) trace?.push(least);
      else trace?.push(isLeastFirst ? least : most, isLeastFirst ? most : least);
    });
  }
  return { times, traces };
}

export interface Curve { points: [number, number][]; x: [number, number]; y: [number, number] }

/** One signal against another, sample by sample; a gap of either breaks the curve (a point of NaN). Between two points that are
    kept no sample lies further from them than the picture can show. */
export function curveOf(record: SampleRecord, [x, y]: [number, number], from_s: number, to_s: number, pixels: number): Curve {
  const first = Math.max(0, record.rowAt(from_s));
  const end = Math.min(record.rows, record.rowAt(to_s) + 1);
  const [xs, ys] = [record.column(x).subarray(first, end), record.column(y).subarray(first, end)];
  const [xRange, yRange] = [rangeOf(xs), rangeOf(ys)];
  const [dx, dy] = [(xRange[1] - xRange[0]) / pixels, (yRange[1] - yRange[0]) / pixels];
  const points: [number, number][] = [];
  let last: [number, number] = [NaN, NaN];
  for (let row = 0; row < xs.length; row++) {
    const point: [number, number] = [xs[row] ?? NaN, ys[row] ?? NaN];
    const isGap = Number.isNaN(point[0]) || Number.isNaN(point[1]);
    if (isGap ? Number.isNaN(last[0]) : Math.abs(point[0] - last[0]) < dx / 2 && Math.abs(point[1] - last[1]) < dy / 2) continue;
    last = isGap ? [NaN, NaN] : point;
    points.push(last);
  }
  return { points, x: xRange, y: yRange };
}

function rangeOf(column: Float32Array): [number, number] {
  const [least, most] = extremes(column, 0, column.length);
  if (least === null || most === null) return [-1, 1];
  return most > least ? [least, most] : [least - 1, least + 1];
}

function extremes(column: Float32Array, from: number, to: number): [number | null, number | null, boolean] {
  let [least, most, leastAt, mostAt] = [Infinity, -Infinity, 0, 0];
  for (let row = from; row < to; row++) {
    const value = column[row] ?? NaN;
    if (value < least) [least, leastAt] = [value, row];
    if (value > most) [most, mostAt] = [value, row];
  }
  return Number.isFinite(least) ? [least, most, leastAt <= mostAt] : [null, null, true];
}
