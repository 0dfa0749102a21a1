// Every page at three widths, light and dark: no serious finding of axe, nothing beyond the edge, the weight as promised.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import axe from 'axe-core';
import { browser, key, open, press, ready, Server, until } from './helpers.mjs';

const pages = ['machine', 'program', 'offsets', 'results', 'results/runs', 'scope', 'alarms'];
const heights = { 360: 780, 1280: 800, 2560: 1440 };
const shots = process.env.SHOTS;
let server; let on; let operator;
// A hole and its thread: every page has something to say.
const hole = 'G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 Z-24 R2 Q8 F900\nG80\nG0 Z50\nT3 M6\nG43 H3\nS3000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 F3000\nG80\nG0 Z50\nM30\n';

before(async () => {
  server = await Server.start();
  writeFileSync(join(server.folder, 'programs/hole.ngc'), hole);
  on = await browser();
  // One tab commands; the others look.
  operator = await open(on, server, { hash: '#program' });
  await ready(operator, server);
  await operator.getByRole('button', { name: /^hole\.ngc/ }).click();
  await press(operator, 'Load');
  await until('it is loaded', async () => (await server.status()).program !== null);
  await press(operator, 'Start');
  await until('it is cut', async () => (await server.status()).execution === 'PROGRAM_COMPLETED', 180_000);
  if (shots) mkdirSync(shots, { recursive: true });
});
after(async () => {
  await on?.close();
  await server?.stop();
});

const serious = async (page) => {
  await page.evaluate(axe.source);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return violations.filter(({ impact }) => impact === 'serious' || impact === 'critical').map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target).join(' ')}`);
};

/** Each page in turn: none is wider than its screen, and a screen reader finds what it needs. */
async function look(names, width, colorScheme, mark = '') {
  const page = await open(on, server, { viewport: { width, height: heights[width] }, colorScheme });
  for (const name of names) {
    await page.goto(`${server.url}/#${name}`);
    await page.waitForTimeout(350);
    if (shots) await page.screenshot({ path: `${shots}/${name.replaceAll('/', '-')}${mark}-${width}-${colorScheme}.png` });
    // on a busy computer what is shown may still be on its way
    await until(`${name} is no wider than the screen`, () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 10_000);
    if (width < 2560) assert.deepEqual(await serious(page), [], name);
  }
  assert.deepEqual(page.faults, []);
  await page.context().close();
}

for (const width of [360, 1280, 2560]) {
  for (const colorScheme of ['light', 'dark']) {
    test(`pages at ${width} px, ${colorScheme}`, { timeout: 60_000 }, () => look(pages, width, colorScheme));
  }
}

test('every key that is shown is 44 px high at least', async () => {
  const page = await open(on, server, { viewport: { width: 360, height: 780 }, hasTouch: true });
  const small = await page.evaluate(() => [...document.querySelectorAll('.key, nav a')].filter((node) => node.offsetParent && node.getBoundingClientRect().height < 43.9).map((node) => node.textContent));
  assert.deepEqual(small, []);
});

test('the keyboard leads it: pages, keys, the list of keys', async () => {
  const page = operator;
  await page.goto(`${server.url}/#machine`);
  for (const power of ['OFF', 'ON']) {
    const power_key = page.getByRole('button', { name: power === 'OFF' ? 'Power off' : 'Power on' });
    await until('the spindle stands', async () => (await power_key.getAttribute('aria-disabled')) === null);
    await page.keyboard.press('F2');
    await until(`power is ${power}`, async () => (await server.status()).power === power);
    await page.getByRole('button', { name: power === 'OFF' ? 'Power on' : 'Power off' }).waitFor(); // the page knows it too
  }
  await page.keyboard.press('?');
  await page.getByRole('dialog').getByText('Stop request').waitFor();
  await page.keyboard.press('Escape');
  await page.keyboard.press('4');
  await page.getByRole('heading', { name: /^(Results|Workpiece)/ }).waitFor();
});

test('a tool is edited in place, in inches too', async () => {
  const page = operator;
  await page.goto(`${server.url}/#offsets`);
  await page.getByRole('button', { name: /^T1 Wear of length/ }).click();
  await page.getByRole('textbox', { name: 'T1 Wear of length' }).fill('-0.25');
  await page.keyboard.press('Enter');
  await until('it is set', async () => Math.abs((await server.get('tools')).find((tool) => tool.number === 1).wear_length_mm + 0.25) < 1e-9);
  await page.keyboard.press('?');
  await page.getByLabel('Unit').selectOption('inch');
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'T1 Wear of length −0.0098' }).waitFor();
});

test('the scope shows samples of the servo loop', async () => {
  const page = operator;
  await page.goto(`${server.url}/#scope`);
  await press(page, 'Run');
  await page.locator('.trace canvas').first().waitFor();
  await press(page, 'Stop');
  await page.getByText('Taken.').waitFor();
  const saved = page.waitForEvent('download');
  await press(page, 'Save');
  assert.match((await saved).suggestedFilename(), /\.csv$/);
  await page.locator('input[type=file][accept*=csv]').setInputFiles(await (await saved).path());
  await page.getByTestId('message').getByText('is laid under it').waitFor();
  await key(page, 'Take it away').waitFor();
  if (shots) await page.screenshot({ path: `${shots}/scope-laid.png` });
  await press(page, 'Spectrum');
  await page.locator('.spectrum canvas').waitFor();
  await page.locator('.spectrum output').getByText('Hz').waitFor();
  if (shots) await page.screenshot({ path: `${shots}/scope-spectrum.png` });
  await press(page, 'Spectrum');
  assert.deepEqual(page.faults, []);
});

test('a program that cannot be cut is refused with its findings, and mended', async () => {
  const page = operator;
  await page.goto(`${server.url}/#program`);
  await page.getByLabel('Name of the program').fill('wrong.ngc');
  await page.locator('.editor .cm-content').click();
  await page.keyboard.press('ControlOrMeta+a');
  await page.keyboard.type('G21 G90\nG0 X9999\nM30\n');
  await press(page, 'Load');
  await page.getByTestId('message').waitFor();
  await page.locator('.findings').getByText('Line 2').first().waitFor();
  await key(page, 'Save').waitFor();
});

test('an alarm says what it is and what mends it, on a telephone too', async () => {
  await operator.getByRole('button', { name: 'Stop request' }).click();
  await until('there is an alarm', async () => (await server.status()).alarms.length > 0);
  for (const width of [360, 1280]) await look(['machine', 'alarms'], width, 'light', '-stopped');
  await operator.goto(`${server.url}/#alarms`);
  const { text, remedy } = (await server.get('alarms')).at(-1);
  for (const words of [text, remedy]) await operator.locator('main').getByText(words).first().waitFor();
});

test('the page without the editor weighs 450 kB at most, compressed', (t) => {
  const folder = fileURLToPath(new URL('../../crates/server/page/assets/', import.meta.url));
  const sizes = readdirSync(folder).filter((name) => !name.startsWith('editor')).map((name) => {
    const bytes = readFileSync(folder + name);
    return name.endsWith('.woff2') ? bytes.length : gzipSync(bytes, { level: 9 }).length;
  });
  const kilobytes = sizes.reduce((all, size) => all + size, 0) / 1000;
  t.diagnostic(`${kilobytes.toFixed(1)} kB`);
  console.log(`page without the editor: ${kilobytes.toFixed(1)} kB compressed`);
  assert.ok(kilobytes <= 450);
});
