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
