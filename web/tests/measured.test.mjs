// What the colours of the path say was measured: the feed with which the tool went over each pair of points.
import assert from 'node:assert/strict';
import { fileURLToPath } from 'node:url';
import { test } from 'node:test';
import { build } from 'vite';

const built = await build({
  root: fileURLToPath(new URL('..', import.meta.url)),
  configFile: false,
  logLevel: 'error',
  build: { write: false, minify: false, lib: { entry: 'src/view/measured.ts', formats: ['es'] } },
});
const { Measured } = await import(`data:text/javascript;base64,${Buffer.from(built[0].output[0].code).toString('base64')}`);

/** A path along X through these places, a line of the program each. */
function pathAlong(...places) {
  const pairs = places.length - 1;
  const points = new Float32Array(pairs * 6);
  for (let pair = 0; pair < pairs; pair++) [points[pair * 6], points[pair * 6 + 3]] = [places[pair], places[pair + 1]];
  return { points, lines: Uint32Array.from({ length: pairs }, (_, pair) => pair + 1), kinds: new Array(pairs).fill('feed'), least: [0, 0, 0], most: [0, 0, 0] };
}

/** Samples of a tool at these places along X, each with its line and the speed of the path. */
const samplesOf = (...places) => places.map(([x, line, feed], step) => ({ time_s: step * 0.02, at: [x, 0, 0], line, feed, sync_um: null }));

test('a pair has the feed it was gone over with, not that of the stop at its end', () => {
  const measured = new Measured(pathAlong(0, 10));
  measured.take(samplesOf([0, 1, 0], [0.2, 1, 600], [0.4, 1, 650], [10, 1, 640], [10.0001, 1, 0], [10, 1, 0]));
  assert.equal(measured.feed[0], 640);
});

test('where the tool only stood nothing was measured', () => {
  const measured = new Measured(pathAlong(0, 10));
  measured.take(samplesOf([0, 1, 0], [0.0001, 1, 0], [0, 1, 0], [0.0002, 1, 0]));
  assert.ok(Number.isNaN(measured.feed[0]), String(measured.feed[0]));
});

test('a tool of another length is at another place, and has not gone there', () => {
  const measured = new Measured(pathAlong(0, 10));
  measured.take(samplesOf([0, 1, 900], [-120, 1, 0], [-119, 1, 300]));
  assert.equal(measured.feed[0], 300);
});

test('pairs shorter than the way between two statuses have the feed of this way', () => {
  const measured = new Measured(pathAlong(0, 0.1, 0.2, 0.3));
  measured.take(samplesOf([0, 1, 0], [0.3, 3, 900]));
  assert.ok(Number.isNaN(measured.feed[0]));
  assert.deepEqual([...measured.feed.slice(1)], [900, 900]);
});

/** A hole along Z, drilled by one line: down with the feed and out of it by rapid, over the same places. */
const hole = { points: Float32Array.of(0, 0, 2, 0, 0, -3, 0, 0, -3, 0, 0, 2), lines: Uint32Array.of(1, 1), kinds: ['feed', 'rapid'], least: [0, 0, -3], most: [0, 0, 2] };
const strokes = (...places) => places.map(([z, feed], step) => ({ time_s: step * 0.1, at: [0, 0, z], line: 1, feed, sync_um: null }));

test('the way out of a hole is not the way in, though it leads over the same places', () => {
  const measured = new Measured(hole);
  measured.take(strokes([2, 0], [1, 600], [0, 600], [-1, 600], [-2, 600], [-3, 600], [-2.7, 1594], [0, 9000], [1.9, 5000], [2, 0]));
  assert.deepEqual([...measured.feed], [600, 9000]);
  assert.equal(measured.doneAt[5], 0);
  assert.equal(measured.doneAt[6], 1);
});

test('a pair has none of the speed with which the one before it was gone', () => {
  const measured = new Measured(hole);
  measured.take(strokes([60, 9000], [1.95, 1800], [1.85, 60], [1.75, 60]));
  assert.equal(measured.feed[0], 60);
});

test('a tool that trembles where it stands does not go back', () => {
  const measured = new Measured(hole);
  measured.take(strokes([2, 0], [0, 600], [0.001, 1], [0, 1], [0.002, 1], [-1, 600]));
  assert.equal(measured.done, 0);
  assert.equal(measured.feed[0], 600);
});
