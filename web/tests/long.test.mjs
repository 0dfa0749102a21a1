// A program of 100,000 lines is opened, edited and checked while another one runs: what runs is finished as if nothing were.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, open, press, ready, Server, until } from './helpers.mjs';

const lines = 100_000;

/** Short moves of a surface, as a CAM system writes them; no line follows the last. */
function surface() {
  const text = ['G21 G90 G17 G94 G54 G64 P0.01', 'T1 M6', 'G43 H1', 'S3000 M3', 'G0 X0 Y0 Z30', 'G1 Z5 F2000'];
  for (let i = 0; text.length < lines - 2; i += 1) {
    const [x, y] = [(i % 1000) / 20, Math.floor(i / 1000) / 4];
    text.push(`X${(Math.floor(i / 1000) % 2 ? 50 - x : x).toFixed(3)} Y${y.toFixed(3)} Z${(5 + Math.sin(x / 3) * Math.cos(y / 3)).toFixed(3)}`);
  }
  return [...text, 'G0 Z50', 'M2'].join('\n');
}

let server; let on; let page;
before(async () => {
  server = await Server.start();
  writeFileSync(join(server.folder, 'programs', 'surface.ngc'), surface());
  on = await browser();
  page = await open(on, server, { hash: '#program' });
});
after(async () => {
  await on?.close();
  await server?.stop();
});

const pick = (name) => page.getByRole('region', { name: 'Folder of programs' }).getByRole('button', { name }).click();
const finding = (code) => page.getByRole('region', { name: 'Findings' }).locator('li').filter({ hasText: code });

test('a program of 100,000 lines is opened, edited and checked while the plate is cut', async () => {
  await ready(page, server);
  await pick('plate-12xM6.ngc');
  await press(page, 'Load');
  await until('the plate is loaded', async () => (await server.status()).program?.name === 'plate-12xM6.ngc');
  await press(page, 'Start');
  await until('it runs', async () => (await server.status()).execution === 'ACTIVE');

  // longest time for which the page took no event, and how long the server took to answer
  await page.evaluate(() => {
    window.longest_ms = 0;
    new PerformanceObserver((list) => { for (const { duration } of list.getEntries()) window.longest_ms = Math.max(window.longest_ms, duration); }).observe({ type: 'longtask' });
  });
  const answers_ms = [];
  let isOver = false;
  const asking = (async () => {
    while (!isOver) {
      const from = performance.now();
      await server.status();
      answers_ms.push(performance.now() - from);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  })().catch(() => {}); // where the test has failed, the server is gone

  const from = performance.now();
  await pick('surface.ngc');
  await page.locator('.editor .cm-line').filter({ hasText: 'G43 H1' }).waitFor();
  const opened_ms = performance.now() - from;
  await page.getByText('Nothing was found').waitFor({ timeout: 120_000 });
  const checked_ms = performance.now() - from;

  // at its end a move beyond the axis is typed
  await page.locator('.editor .cm-content').click();
  await page.keyboard.press('ControlOrMeta+End');
  await page.locator('.editor .cm-line').filter({ hasText: /^M2$/ }).waitFor();
  await page.keyboard.press('Home');
  const typed = performance.now();
  await page.keyboard.type('G0 X900\n');
  const found = finding('M0301');
  await found.getByText(`Line ${lines}`).waitFor({ timeout: 120_000 });
  const found_ms = performance.now() - typed;
  await press(page, `Write X250, line ${lines}`);
  await until('the finding is gone', async () => (await found.count()) === 0, 120_000);

  const { execution, program } = await server.status();
  assert.ok(execution === 'ACTIVE' || execution === 'PROGRAM_COMPLETED', execution);
  assert.equal(program.name, 'plate-12xM6.ngc', 'the text that is edited is not the program that runs');
  await until('the plate is finished', async () => (await server.status()).execution === 'PROGRAM_COMPLETED', 180_000);
  isOver = true;
  await asking;
  const { features, alarms } = await server.status();
  assert.deepEqual([features.good, features.failed, alarms.length], [36, 0, 0]);
  assert.deepEqual(page.faults, []);
  answers_ms.sort((a, b) => a - b);
  const ms = (value) => `${Math.round(value)} ms`;
  console.log(`opened ${ms(opened_ms)}, checked ${ms(checked_ms)}, found what was typed ${ms(found_ms)}, page busy at most ${ms(await page.evaluate(() => window.longest_ms))}, status answered p50 ${ms(answers_ms[answers_ms.length >> 1])} worst ${ms(answers_ms.at(-1))}`);
});

test('it is loaded and started before its time is known', async () => {
  await page.reload();
  await pick('surface.ngc');
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name === 'surface.ngc');
  const before = (await server.status()).program;
  assert.deepEqual([before.planned_s, before.left_s], [null, null]);
  await page.evaluate(() => { location.hash = '#machine'; });
  await page.locator('.program .time').getByText('… planned').waitFor();
  await press(page, 'Start');
  await until('it runs', async () => (await server.status()).execution === 'ACTIVE');
  await until('its time is known while it runs', async () => (await server.status()).program.left_s > 60, 300_000);
  await page.locator('.program .time').getByText(/^\d.* left$/).waitFor();
  await press(page, 'Stop');
  await until('it is stopped', async () => (await server.status()).execution !== 'ACTIVE');
  assert.deepEqual(page.faults, []);
});
