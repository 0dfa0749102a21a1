// The control is killed with a tap in its thread. The machine lives on; what the next control knows of it, the page shows on the
// whole screen, and one key takes the tap out.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, Machine, open, press, ready, Server, until } from './helpers.mjs';

const shots = process.env.SHOTS;
let machine; let server; let on; let page;
before(async () => {
  if (shots) mkdirSync(shots, { recursive: true });
  machine = await Machine.start();
  server = await Server.start(['--simulator', machine.socket]);
  on = await browser();
  page = await open(on, server);
  await ready(page, server);
});
after(async () => {
  await on?.close();
  await server?.stop();
  machine?.stop();
});

const isDeep = async () => {
  const status = await server.status();
  return status.activity === 'tap-in' && status.axes[2].work < -8;
};

/** The plate is cut until a tap is deep in its thread. */
async function untilInTap() {
  await page.goto(`${server.url}/#program`);
  await page.getByRole('button', { name: /^plate-12xM6\.ngc/ }).click();
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name === 'plate-12xM6.ngc');
  await press(page, 'Start');
  await until('a tap is deep in its thread', isDeep, 120_000);
}

/** The plate is held with a tap in its thread: the next one, where the key came too late for this one. */
async function holdInTap() {
  await untilInTap();
  for (let tap = 1; tap < 12; tap += 1) {
    await press(page, 'Hold');
    await until('it is held', async () => (await server.status()).execution === 'FEED_HOLD');
    if ((await server.status()).is_tool_in_work) return;
    await press(page, 'Resume');
    await until('a tap is deep in its thread', isDeep);
  }
  assert.fail('each of the taps was out of its thread before it was held');
}

test('held in a tap, the power fails: the page says what is so, and the next control takes the tap out by one key', { timeout: 180_000 }, async () => {
  await holdInTap();
  await page.goto(`${server.url}/#machine`);
  await page.getByText('The tap is held in its thread.').waitFor();
  machine.cutPower();
  await until('there is an alarm', async () => (await server.status()).alarms.length > 0);
  await page.getByRole('heading', { name: 'A tool stands in its thread' }).waitFor();
  // this control has no machine any more: the key says so, and the tool stays known
  await press(page, 'Take it out along the thread');
  await page.getByTestId('message').filter({ hasText: 'start the control again' }).waitFor();
  assert.equal((await server.status()).is_tool_in_work, true);
  assert.equal(machine.told().tap_in_thread, true);

  await server.kill();
  await server.again();
  await page.getByText('µm off its thread, known within').waitFor({ timeout: 20_000 });
  await press(page, 'Take it out along the thread');
  await until('the tap is out', async () => !(await server.status()).is_tool_in_work, 60_000);
  assert.equal(machine.told().tap_in_thread, false);
  assert.equal(machine.told().tool_broken, false);
  await page.goto(`${server.url}/#machine`);
  await press(page, 'Home all');
  await until('all axes are homed', async () => (await server.status()).axes.every((axis) => axis.is_homed), 60_000);
});

test('killed in a tap, it begins again, says what is known on the whole screen, and one key takes the tap out', { timeout: 180_000 }, async () => {
  await untilInTap();
  await server.kill();
  const stopped = machine.told();
  assert.equal(stopped.tap_in_thread, true);
  assert.equal(stopped.tool_in_work, 3);

  await server.again();
  await page.getByRole('heading', { name: 'A tool stands in its thread' }).waitFor({ timeout: 20_000 });
  const { left_in_work: left } = await server.status();
  const text = await page.locator('.recovery').innerText();
  assert.match(text, new RegExp(`Tool 3, left in hole ${left.hole} of .*plate-12xM6\\.ngc \\(line ${left.line}\\)`));
  assert.match(text, /µm off its thread, known within [\d.]+ µm/);
  assert.match(text, /follows it along the thread/);
  // Z is not homed: where the tap stands is known by its depth alone
  assert.match(text, /Where\s+1?\d\.\d\d mm below the surface/);
  assert.ok(Math.abs(left.off_thread_um - stopped.off_helix_um) <= left.within_um, JSON.stringify({ left, stopped }));
  // it takes the whole screen, on every page, and nothing else can be asked for but the emergency stop
  const size = await page.locator('.recovery').boundingBox();
  assert.ok(size.width > 1100 && size.height > 500, JSON.stringify(size));
  if (shots) await page.screenshot({ path: join(shots, 'recovery.png') });

  await press(page, 'Take it out along the thread');
  await until('the tap is out', async () => !(await server.status()).is_tool_in_work, 60_000);
  await page.getByRole('heading', { name: 'A tool stands in its thread' }).waitFor({ state: 'detached' });
  await until('the record says so', async () => (await server.get('events?after=0')).events.some((event) => event.text === 'the tool is out of the work'));

  // from its hole on to the end
  await page.goto(`${server.url}/#machine`);
  await press(page, 'Home all');
  await until('all axes are homed', async () => (await server.status()).axes.every((axis) => axis.is_homed), 60_000);
  await page.goto(`${server.url}/#program`);
  await page.getByRole('button', { name: /^plate-12xM6\.ngc/ }).click();
  await press(page, 'Load');
  await until('it is loaded', async () => (await server.status()).program?.name === 'plate-12xM6.ngc');
  await page.getByLabel('Number').fill(String(left.hole));
  await press(page, 'Search');
  await press(page, 'Start');
  await until('the end', async () => (await server.status()).execution === 'PROGRAM_COMPLETED', 120_000);
  const features = await server.get('features');
  assert.equal(features.length, 36 - left.hole + 1);
  assert.deepEqual(features.filter((feature) => feature.verdict !== 'good'), []);
  assert.deepEqual(page.faults, []);
  await server.stop();
  const last = machine.told();
  assert.equal(last.tool_broken, false);
  assert.equal(last.tool_in_work, null);
});
