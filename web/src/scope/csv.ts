// A saved trace as text: `time_s` first, then a column for each signal; an empty field has no value.
import type { SampleRecord } from './record';
import { storedTexts as say } from '../texts/en';

export interface Table { names: string[]; columns: Float32Array[]; period_s: number; start_s: number }

/** A record as text: its conditions as lines of `#`, then a row for each period. */
export function csvOf(record: SampleRecord, conditions: Record<string, string>): string {
  const columns = record.signals.map((_, index) => record.column(index));
  const lines = [...Object.entries(conditions).map(([name, value]) => `# ${name}: ${value}`), ['time_s', ...record.signals].join(',')];
  for (let row = 0; row < record.rows; row++) {
    const time = (record.start_s + row * record.period_s).toFixed(6);
    lines.push([time, ...columns.map((column) => (Number.isNaN(column[row]) ? '' : String(column[row])))].join(','));
  }
  return lines.join('\n');
}

export function parsed(text: string): Table {
  const lines = text.split(/\r?\n/);
  const headAt = lines.findIndex((line) => line !== '' && !line.startsWith('#'));
  const head = (lines[headAt] ?? '').split(',');
  if (headAt < 0 || head[0] !== 'time_s' || head.length < 2) throw new Error(say.noHead);
  const body = lines.slice(headAt + 1).filter((line) => line !== '');
  const names = head.slice(1);
  const columns = names.map(() => new Float32Array(body.length));
  const times = body.map((line, row) => {
    const fields = line.split(',');
    if (fields.length !== head.length) throw new Error(say.wrongFields(headAt + row + 2, fields.length, head.length));
    fields.forEach((field, index) => {
      const isEmpty = field.trim() === '';
      if (isEmpty ? index === 0 : !Number.isFinite(Number(field))) throw new Error(say.noNumber(headAt + row + 2, field));
      const column = columns[index - 1];
      if (column) column[row] = isEmpty ? NaN : Number(field);
    });
    return Number(fields[0]);
  });
  const [first, last] = [times[0] ?? NaN, times.at(-1) ?? NaN];
  const period_s = (last - first) / (times.length - 1);
  if (!(period_s > 0)) throw new Error(say.noRows);
  return { names, columns, period_s, start_s: first };
}
