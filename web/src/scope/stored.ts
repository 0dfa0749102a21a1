// A trace that was saved before, to be laid over the one that is taken: read from the file that `save` writes.
import { parsed, type Table } from './csv';
import { drawn, type Drawn } from './draw';
import { SampleRecord } from './record';

/** A record of the file; throws a sentence where it is none. */
export function recordOf(text: string): SampleRecord {
  const { names, columns, period_s, start_s }: Table = parsed(text);
  const rows = columns[0]?.length ?? 0;
  const record = new SampleRecord(names, period_s, rows);
  record.add({ rows, start_s, period_s, signals: names, lost_rows: 0, columns });
  return record;
}

/** What is laid over: its first row lies where the trace begins that is shown. */
export function laid(record: SampleRecord, from: number, to: number, most_points: number): Drawn {
  return drawn(record, record.start_s, record.start_s + (to - from), record.start_s - from, most_points);
}
