// The scope takes what was before an alarm, and what was taken is a file that other programs read: CSV, Parquet, MCAP.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { parquetMetadata, parquetReadObjects } from 'hyparquet';
import { browser, open, press, Server, until } from './helpers.mjs';
import { readMcap } from './mcap.mjs';

let server; let on; let page;
before(async () => {
  server = await Server.start();
  on = await browser();
  page = await open(on, server, { acceptDownloads: true });
  await press(page, 'Power on');
  await until('the drives are ready', async () => (await server.status()).is_ready);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

async function saved(format) {
  await page.getByLabel('Format of the file').selectOption(format);
  const [file] = await Promise.all([page.waitForEvent('download'), press(page, 'Save')]);
  assert.match(file.suggestedFilename(), new RegExp(`\\.${format}$`));
  return readFileSync(await file.path());
}

test('an alarm triggers, and what was before it is taken', async () => {
  await page.goto(`${server.url}/#scope`);
  await page.getByLabel('Edge').selectOption('alarm');
  await page.getByLabel('Before it').selectOption('80');
  await press(page, 'Single');
  await page.getByText('Waits for the trigger.').waitFor();
  await new Promise((resolve) => setTimeout(resolve, 2500));
  await press(page, 'Stop request');
  await page.getByText('Taken.').waitFor();
  const { time_s } = (await server.get('alarms')).at(-1);
  const [head, ...rows] = (await saved('csv')).toString().split('\n').filter((line) => !line.startsWith('#'));
  assert.match(head, /^time_s,/);
  const times = rows.map((row) => Number(row.split(',')[0]));
  assert.ok(times[0] < time_s - 1.5 && times.at(-1) >= time_s + 0.3, `${times[0]} … ${times.at(-1)}, alarm at ${time_s}`);
});

test('Parquet and MCAP hold the same samples as the text, with units', async () => {
  const text = (await saved('csv')).toString().split('\n');
  const head = text.find((line) => line.startsWith('time_s')).split(',');
  const rows = text.slice(text.findIndex((line) => line.startsWith('time_s')) + 1).map((row) => row.split(','));
  const column = head.indexOf('Z.position_mm');
  assert.ok(column > 0, head.join());

  const bytes = await saved('parquet');
  const file = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const about = parquetMetadata(file);
  assert.equal(about.key_value_metadata.find(({ key }) => key === 'unit:Z.position_mm').value, 'mm');
  const table = await parquetReadObjects({ file });
  assert.equal(table.length, rows.length);
  for (const row of [0, 17, rows.length - 1]) assert.ok(Math.abs(table[row]['Z.position_mm'] - Number(rows[row][column])) < 1e-4);

  const { about: facts, rows: messages } = await readMcap(await saved('mcap'));
  assert.equal(messages.length, rows.length);
  messages.forEach((message, row) => {
    assert.equal(message.log_ns, BigInt(Math.round(message.time_s * 1e9)));
    assert.ok(Math.abs(message.Z_position_mm - Number(rows[row][column])) < 1e-4);
  });
  assert.equal(facts.get('unit:Z.position_mm'), 'mm');
  assert.equal(facts.get('machine'), 'tapping-center');
  assert.deepEqual(page.faults, []);
});
