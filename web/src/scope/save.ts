// A record as a file: columns of text under the conditions in which it was taken.
import type { Status } from '../control/model';
import { machine } from '../control/machine.svelte';
import { scope } from './scope.svelte';

export function save(status: Status | null): void {
  const record = scope.record;
  if (!record) return;
  const head = [
    `# machine ${machine.facts?.name ?? ''}, program ${status?.program?.name ?? 'none'}, tool ${status?.tool ?? 'none'}`,
    `# from ${record.start_s} s of machine time, a row each ${record.period_s} s, ${record.lost} rows lost`,
    ['time_s', ...record.signals].join(','),
  ];
  const columns = record.signals.map((_, index) => record.column(index));
  const rows: string[] = [];
  for (let row = 0; row < record.rows; row++) {
    const time = (record.start_s + row * record.period_s).toFixed(6);
    rows.push([time, ...columns.map((column) => (Number.isNaN(column[row]) ? '' : String(column[row])))].join(','));
  }
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([[...head, ...rows].join('\n')], { type: 'text/csv' }));
  link.download = `scope-${record.start_s.toFixed(1)}s.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
