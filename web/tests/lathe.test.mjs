// A lathe's path as its operator sees the machine: the chuck on the left, Z to the right.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, open, press, ready, Server, until } from './helpers.mjs';

const turned = `G21 G18 G90 G94 G8
T33 M6
G43 H33
S800 M3
G0 X9 Y0 Z60
G0 Z5
G1 Z-40 F100
G0 X20
G0 Z60
M30
`;
let server; let on; let page;
before(async () => {
  server = await Server.start(['--machine', 'lathe']);
  on = await browser();
  page = await open(on, server);
  await ready(page, server);
  writeFileSync(join(server.folder, 'programs/turned.ngc'), turned);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

test('a cut ends towards the chuck, on the left', { timeout: 120_000 }, async () => {
  await page.goto(`${server.url}/#program`);
  await page.getByRole('button', { name: /^turned\.ngc/ }).click();
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name === 'turned.ngc');
  await page.goto(`${server.url}/#machine`);
  const canvas = page.locator('.view canvas');
  await canvas.waitFor();
  await page.waitForTimeout(1000);
  const { x, y, width, height } = await canvas.boundingBox();
  const chosen = page.locator('.view .chosen');
  // Above the cut there is only the way out of it, from the end that is nearest to the chuck.
  let found = 0;
  for (let right = 0.02; right < 1 && !found; right += 0.02) {
    await page.mouse.click(x + right * width, y + 0.25 * height);
    if (await chosen.count()) found = right;
  }
  assert.match(await chosen.innerText(), /8/);
  assert.ok(found < 0.5, `${found} of the picture's width`);
});
