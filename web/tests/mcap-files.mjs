// For `tools/traces`: reads an MCAP with Foxglove's libraries as JSON, or writes one with the page's own code, of a record that is known.
import { readFileSync, writeFileSync } from 'node:fs';
import { readMcap } from './mcap.mjs';

const [, , what, file, bundle] = process.argv;
if (what === 'read') {
  const { about, rows } = await readMcap(readFileSync(file));
  // a bigint is a text there; NaN is null
  console.log(JSON.stringify({ about: Object.fromEntries(about), rows }, (_, value) => (typeof value === 'bigint' ? String(value) : value)));
} else {
  const { mcapOf } = await import(bundle);
  const rows = 4000;
  const columns = [Float32Array.from({ length: rows }, (_, row) => Math.sin(row / 100)), Float32Array.from({ length: rows }, (_, row) => (row % 3 ? NaN : row / 8))];
  const record = { signals: ['X.setpoint_mm', 'sync_error_um'], period_s: 0.00025, start_s: 12.5, rows, column: (signal) => columns[signal] };
  const blob = await mcapOf(record, { machine: 'lathe' });
  writeFileSync(file, new Uint8Array(await blob.arrayBuffer()));
}
