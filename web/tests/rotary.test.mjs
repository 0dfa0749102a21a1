// A machine with a tilting rotary table: what is said of A and C is degrees, what is said of X is millimetres.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, open, press, Server, until } from './helpers.mjs';

let server; let on; let page;
before(async () => {
  server = await Server.start(['--machine', 'mill-5-axis']);
  on = await browser();
  page = await open(on, server);
  // An axis may be jogged before it is homed.
  await press(page, 'Power on');
  await until('the drives are ready', async () => (await server.status()).is_ready);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

test('the pad says how fast each kind of axis is, in its own unit', async () => {
  const speeds = await page.locator('label.speed .num').innerText();
  assert.match(speeds, /^[\d.]+ mm\/min · [\d.]+ °\/min$/);
});

test('a rotary axis turns by a step of degrees, whatever unit is shown', async () => {
  const turns = async () => {
    const from = (await server.axis('A')).machine;
    await page.getByRole('radio', { name: '1', exact: true }).click();
    await page.locator('[data-jog="A+"]').click();
    await until('A has turned by a degree', async () => Math.abs((await server.axis('A')).machine - (from + 1)) < 0.01);
  };
  await turns();
  await page.evaluate(() => localStorage.setItem('leadscrew.display', JSON.stringify({ unit: 'inch' })));
  await page.reload();
  await page.locator('[data-execution]').waitFor();
  assert.match(await page.locator('label.speed .num').innerText(), /in\/min · [\d.]+ °\/min$/);
  await turns();
  assert.deepEqual(page.faults, []);
});
