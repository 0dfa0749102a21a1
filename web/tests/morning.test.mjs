// A shop's morning by clicks: power on, home, jog, load, start, hold, resume; 36 features, each of them good.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, key, open, press, ready, Server, touch, until } from './helpers.mjs';

let server; let on; let page;
before(async () => {
  server = await Server.start();
  on = await browser();
  page = await open(on, server);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

test('a key that cannot be used says why when it is touched', async () => {
  await touch(page, 'Home all');
  await page.getByTestId('message').getByText('The drives are not on').waitFor();
  await touch(page, 'Start');
  await page.getByTestId('message').getByText('No program is loaded: load one first').waitFor();
});

test('the drives come on and the axes are homed', async () => {
  await ready(page, server);
  await until('the page says of no axis that it is not homed', async () => (await page.getByText('not homed').count()) === 0);
});

test('an axis moves as long as its key is held, and by a step when a step is chosen', async () => {
  const from = (await server.axis('X')).machine;
  const box = await page.locator('[data-jog="X-"]').boundingBox();
  await page.mouse.move(box.x + 20, box.y + 20);
  await page.mouse.down();
  await until('X moves', async () => (await server.axis('X')).machine < from - 5);
  await page.mouse.up();
  const still = await until('X stands', async () => {
    const a = (await server.axis('X')).machine;
    await new Promise((resolve) => setTimeout(resolve, 150));
    const b = (await server.axis('X')).machine;
    return Math.abs(a - b) < 1e-6 ? b : null;
  });
  await page.getByRole('radio', { name: '10', exact: true }).click();
  await page.locator('[data-jog="X-"]').click();
  await until('X has moved by 10 mm', async () => Math.abs((await server.axis('X')).machine - (still - 10)) < 0.002);
});

test('a typed block is executed and kept', async () => {
  await page.getByRole('tab', { name: 'MDI' }).click();
  await page.locator('#mdi').fill('G91 G0 X-5');
  const from = (await server.axis('X')).machine;
  await press(page, 'Execute');
  await until('X has moved by 5 mm', async () => Math.abs((await server.axis('X')).machine - (from - 5)) < 0.002);
  await key(page, 'G91 G0 X-5').waitFor();
  await page.locator('#mdi').fill('G90');
  await press(page, 'Execute');
  // What is typed before the answer has come is not lost.
  await page.locator('#mdi').fill('G91');
  await key(page, 'G90').waitFor();
  await until('the block is over', async () => (await server.status()).program === null);
  assert.equal(await page.locator('#mdi').inputValue(), 'G91');
});

test('what a program says to its operator is read where he waits', async () => {
  await page.locator('#mdi').fill('(MSG, TURN THE PART) M0');
  await press(page, 'Execute');
  await page.getByTestId('program-message').getByText('TURN THE PART').waitFor();
  await page.getByText('waits for operator').waitFor();
  await press(page, 'Confirm');
  await until('the block is over', async () => (await server.status()).program === null || !(await server.status()).waiting_for);
});

test('the plate is loaded, held, resumed, and finished with 36 good features', { timeout: 170_000 }, async () => {
  await page.getByRole('link', { name: 'Program' }).click();
  await page.getByRole('button', { name: /^plate-12xM6\.ngc/ }).click();
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name.includes('plate-12xM6'));
  await page.getByRole('link', { name: 'Machine' }).click();
  await press(page, 'Start');
  await page.locator('[data-execution="ACTIVE"]').waitFor();
  await until('its first hole is cut', async () => (await server.status()).features.good > 0, 40_000);
  await press(page, 'Hold');
  await page.locator('[data-execution="FEED_HOLD"]').waitFor();
  await press(page, 'Resume');
  await page.locator('[data-execution="ACTIVE"]').waitFor();
  await until('it is completed', async () => (await server.status()).execution === 'PROGRAM_COMPLETED', 150_000);
  const { features } = await server.status();
  assert.deepEqual(features, { good: 36, failed: 0, not_judged: 0 });
  await page.getByRole('link', { name: 'Results' }).click();
  await key(page, '36 good').waitFor();
  assert.deepEqual(page.faults, []);
});
