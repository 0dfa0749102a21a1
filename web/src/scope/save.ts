// A record as a file, with the conditions in which it was taken.
import type { Status } from '../control/model';
import { machine } from '../control/machine.svelte';
import { csvOf } from './csv';
import type { SampleRecord } from './record';
import { scope } from './scope.svelte';

export type Format = 'csv' | 'parquet' | 'mcap';
export const formats: Format[] = ['csv', 'parquet', 'mcap'];
export type Conditions = Record<string, string>;

function conditionsOf(record: SampleRecord, status: Status | null): Conditions {
  return {
    machine: machine.facts?.name ?? '', program: status?.program?.name ?? 'none', tool: String(status?.tool ?? 'none'),
    start_s: String(record.start_s), period_s: String(record.period_s), lost_rows: String(record.lost),
    trigger_s: scope.trigger_s === null ? 'none' : String(scope.trigger_s),
  };
}

/** Formats that few need come when they are asked for. */
async function written(record: SampleRecord, conditions: Conditions, format: Format): Promise<Blob> {
  if (format === 'parquet') return new Blob([(await import('./parquet')).parquetOf(record, conditions)], { type: 'application/vnd.apache.parquet' });
  if (format === 'mcap') return new Blob([await (await import('./mcap')).mcapOf(record, conditions)], { type: 'application/octet-stream' });
  return new Blob([csvOf(record, conditions)], { type: 'text/csv' });
}

export async function save(status: Status | null, format: Format): Promise<void> {
  const record = scope.record;
  if (!record) return;
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await written(record, conditionsOf(record, status), format));
  link.download = `scope-${record.start_s.toFixed(1)}s.${format}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
