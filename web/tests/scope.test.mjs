// What the scope computes, held against closed forms: amplitudes of a spectrum, a trace that was saved.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { createServer } from 'vite';

let vite; let spectrumOf; let recordOf;
before(async () => {
  vite = await createServer({ root: fileURLToPath(new URL('..', import.meta.url)), configFile: false, logLevel: 'error', server: { middlewareMode: true, hmr: false, ws: false }, optimizeDeps: { noDiscovery: true } });
  ({ spectrumOf } = await vite.ssrLoadModule('/src/scope/spectrum.ts'));
  ({ recordOf } = await vite.ssrLoadModule('/src/scope/stored.ts'));
});
after(() => vite?.close());

const sine = (rows, of) => Float32Array.from({ length: rows }, (_, row) => of(row));

test('a sine has its amplitude at its frequency, and a constant has none', () => {
  // 1,024 rows at 4 kHz: 3.90625 Hz a step, so 250 Hz is value 64.
  const { hz, amplitude } = spectrumOf(sine(1024, (row) => 5 + 3 * Math.sin((2 * Math.PI * 250 * row) / 4000)), 1 / 4000);
  assert.equal(hz[64], 250);
  assert.ok(Math.abs(amplitude[64] - 3) < 1e-5, `${amplitude[64]}`);
  // The Hann window gives half to each neighbour and nothing beyond.
  assert.ok(Math.abs(amplitude[63] - 1.5) < 1e-5 && Math.abs(amplitude[65] - 1.5) < 1e-5);
  assert.ok(amplitude.every((value, k) => Math.abs(k - 64) <= 1 || value < 1e-4));
});

test('a gap is not bridged: the longest stretch without one is taken', () => {
  const column = sine(1000, (row) => (row < 300 ? NaN : Math.cos((2 * Math.PI * row) / 8)));
  const { hz, amplitude, step_hz } = spectrumOf(column, 0.001);
  assert.equal(step_hz, 1000 / 512);
  const peak = amplitude.indexOf(Math.max(...amplitude));
  assert.equal(hz[peak], 125);
  assert.equal(spectrumOf(sine(63, () => 1), 0.001), null);
  assert.equal(spectrumOf(sine(500, () => NaN), 0.001), null);
});

test('a saved trace is read again, with its gaps', () => {
  const record = recordOf('# machine m\ntime_s,Z.position_mm,sync_error_um\n1.000000,-1.5,\n1.000250,-2.5,0.25\n1.000500,-3.5,-0.5\n');
  assert.deepEqual(record.signals, ['Z.position_mm', 'sync_error_um']);
  assert.ok(Math.abs(record.period_s - 0.00025) < 1e-12);
  assert.deepEqual([...record.column(0)], [-1.5, -2.5, -3.5]);
  assert.deepEqual([...record.column(1)], [NaN, 0.25, -0.5]);
});

test('what is no saved trace is refused with its place', () => {
  assert.throws(() => recordOf('G21 G90\n'), /its first line has to be time_s/);
  assert.throws(() => recordOf('time_s,a\n0,1\n1\n'), /line 3 has 1 fields: 2 are named/);
  assert.throws(() => recordOf('time_s,a\n0,1\n1,x\n'), /line 3: "x" is no number/);
  assert.throws(() => recordOf('time_s,a\n0,1\n0,1\n'), /two rows whose time grows/);
});

test('one signal against another is drawn sample by sample, however long the span: a circle stays a circle, a gap a gap', async () => {
  const { curveOf } = await vite.ssrLoadModule('/src/scope/draw.ts');
  const { SampleRecord } = await vite.ssrLoadModule('/src/scope/record.ts');
  const [rows, period_s] = [40_000, 0.00025];
  const record = new SampleRecord(['a', 'b'], period_s, rows);
  const angle = (row) => (2 * Math.PI * 37 * row) / rows;
  const columns = [Float32Array.from({ length: rows }, (_, row) => Math.cos(angle(row))), Float32Array.from({ length: rows }, (_, row) => Math.sin(angle(row)))];
  columns[1].fill(NaN, 10_000, 10_100);
  record.add({ rows, start_s: 0, period_s, signals: ['a', 'b'], lost_rows: 0, columns });
  const curve = curveOf(record, [0, 1], 0, rows * period_s, 400);
  const gaps = curve.points.filter(([a]) => Number.isNaN(a));
  assert.equal(gaps.length, 1);
  for (const [a, b] of curve.points) if (!Number.isNaN(a)) assert.ok(Math.abs(Math.hypot(a, b) - 1) < 1e-6, `${a} ${b}`);
  assert.ok(curve.points.length > 2000 && curve.points.length < rows, `${curve.points.length}`);
  assert.deepEqual([curve.x, curve.y].flat().map((value) => Math.round(value * 1e4) / 1e4), [-1, 1, -1, 1]);
});
