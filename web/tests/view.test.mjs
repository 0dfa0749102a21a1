// The picture of the path: its colours say what was measured and judged, and a run that has ended can be gone through.
import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, open, press, ready, Server, until } from './helpers.mjs';

const twoHoles = `G21 G17 G40 G49 G80 G90 G94 G54 G64
T1 M6
G43 H1
S5000 M3
G0 X12 Y12 Z30
G99 G81 X12 Y12 Z-3.3 R2 F60
X44
G80
G0 Z30
M30
`;
const shots = process.env.SHOTS;
let server; let on; let page;
const legend = () => page.locator('.view .legend');
const shot = async (name) => { if (shots) await page.screenshot({ path: `${shots}/${name}.png` }); };
before(async () => {
  if (shots) mkdirSync(shots, { recursive: true });
  server = await Server.start();
  on = await browser();
  page = await open(on, server);
  await ready(page, server);
  writeFileSync(join(server.folder, 'programs/two.ngc'), twoHoles);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

test('before a run nothing is said to be measured', async () => {
  await page.goto(`${server.url}/#program`);
  await page.getByRole('button', { name: /^two\.ngc/ }).click();
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name === 'two.ngc');
  await page.goto(`${server.url}/#machine`);
  await page.getByLabel('Colours of the path').selectOption('feed');
  await legend().getByText('nothing measured yet').waitFor();
});

test('after it the feed was measured within what was programmed and the rapid, and the holes have their verdicts', { timeout: 60_000 }, async () => {
  await press(page, 'Start');
  // Another page is shown meanwhile: the run is seen all the same.
  await page.goto(`${server.url}/#alarms`);
  await until('it is completed', async () => (await server.status()).execution === 'PROGRAM_COMPLETED', 50_000);
  await page.goto(`${server.url}/#machine`);
  await page.getByLabel('Colours of the path').selectOption('feed');
  const said = await legend().locator('li.num').evaluate((item) => [...item.childNodes].map((node) => node.textContent.trim()).filter(Boolean).join(' '));
  const [least, most] = said.match(/\d+/g).map(Number);
  const rapids = (await server.get('machine')).axes.map((axis) => axis.rapid_per_min);
  assert.ok(least > 0 && least <= 60 && most > 60 && most <= Math.hypot(...rapids), said);
  await shot('view-feed');
  await page.getByLabel('Colours of the path').selectOption('verdict');
  await legend().getByText('out of tolerance').waitFor();
  await shot('view-verdict');
});

test('the run is gone through by the slider and by steps, and the program shows the line', async () => {
  const slider = page.getByRole('slider', { name: 'Go through the run' });
  await slider.focus();
  await page.keyboard.press('Home');
  await page.getByRole('button', { name: 'Step on' }).click();
  const text = await page.locator('.scrub output').innerText();
  assert.match(text, /^Line \d+, Z [+−]\d/);
  await until('the line is chosen', async () => page.locator('.view .chosen').count());
  await shot('view-scrub');
  await page.keyboard.press('Escape');
  assert.deepEqual(page.faults, []);
});

test('a touch on the path leads to its line', async () => {
  await page.locator('.view .chosen').click();
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  await page.waitForTimeout(400);
  const box = await page.locator('.view canvas').boundingBox();
  // From above the two holes lie beside one another in the middle of the picture, and the path joins them.
  const spots = [-4, -2, 0, 2, 4].map((y) => [box.width / 2 + 6, box.height / 2 + y]);
  for (const [x, y] of spots) {
    await page.locator('.view canvas').click({ position: { x, y } });
    if (await page.locator('.view .chosen').count()) break;
  }
  await page.locator('.view .chosen').getByText(/^Line [5-9]/).waitFor();
});
