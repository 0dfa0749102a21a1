// A jog is a lease of the control: it ends with the page that holds it.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, open, ready, Server, until } from './helpers.mjs';

const lease_s = 0.2;
let server; let on; let page;
before(async () => {
  server = await Server.start();
  on = await browser();
  page = await open(on, server);
  await ready(page, server);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

async function hold(letter, sign) {
  const from = (await server.axis(letter)).machine;
  const box = await page.locator(`[data-jog="${letter}${sign}"]`).boundingBox();
  await page.mouse.move(box.x + 20, box.y + 20);
  await page.mouse.down();
  await until(`${letter} moves`, async () => Math.abs((await server.axis(letter)).machine - from) > 2);
}

/** The axis' place once it does not move any more. */
const standstill = (letter) => until(`${letter} stands`, async () => {
  const before = (await server.axis(letter)).machine;
  await new Promise((resolve) => setTimeout(resolve, 250));
  const now = (await server.axis(letter)).machine;
  return Math.abs(now - before) < 1e-6 ? { at: now } : null;
}, 5000);

for (const [what, event] of [
  ['loses the focus', () => window.dispatchEvent(new Event('blur'))],
  ['loses the pointer', () => window.dispatchEvent(new PointerEvent('pointercancel'))],
]) {
  test(`the axis stops when the page ${what}, with the key still pressed`, async () => {
    await hold('Y', '-');
    await page.evaluate(event);
    await standstill('Y');
    await page.mouse.up();
  });
}

test('the tab is closed in mid-jog: the axis stops within its lease and its limits', async () => {
  await hold('X', '-');
  const { machine: at } = await server.axis('X');
  await page.close({ runBeforeUnload: false });
  const { at: end } = await standstill('X');
  const { axes } = await server.get('machine');
  const limits = axes.find((axis) => axis.letter === 'X');
  assert.ok(end >= limits.travel_from && end <= limits.travel_to, `${end}`);
  // 3,000 mm/min for the lease, the way of closing a tab (1 s at most), and the ramp.
  assert.ok(Math.abs(end - at) < 50 * (lease_s + 1) + 5, `it went on for ${Math.abs(end - at)} mm`);
  assert.equal((await server.status()).alarms.length, 0);
});
