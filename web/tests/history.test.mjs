// The history of runs: found again by search, with report and certificate, and two laid over each other.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, open, press, ready, Server, until } from './helpers.mjs';

let server; let on; let page;
const spot = (depth) => `G21 G90 G54\nT1 M6\nG43 H1\nS5000 M3\nG0 X12 Y12 Z30\nG99 G81 Z-${depth} R2 F600\nX44\nG80\nG0 Z50\nM5\nM30\n`;
const tap = 'G21 G90 G54\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 Z-24 R2 Q8 F900\nG80\nG0 Z50\nT3 M6\nG43 H3\nS3000 M3\nG0 X12 Y12 Z30\nG99 G84 Z-17 R5 F3000\nG80\nG0 Z50\nM30\n';

async function execute(name, text) {
  const asked = (body) => fetch(`${server.url}/api/v1/request`, { method: 'POST', headers: { 'x-leadscrew-session': session }, body: JSON.stringify(body) }).then((answer) => answer.json());
  const session = await page.evaluate(() => JSON.parse(sessionStorage.getItem('leadscrew.session')).session);
  await fetch(`${server.url}/api/v1/programs/${name}?replace=true`, { method: 'PUT', headers: { 'x-leadscrew-session': session }, body: text });
  const before = (await server.get('runs')).runs.length;
  for (const body of [{ request: 'load', program: name }, { request: 'start' }]) {
    const answer = await asked(body);
    assert.ok(answer.accepted, JSON.stringify(answer));
  }
  await until(`${name} is kept`, async () => (await server.get('runs')).runs.length > before, 60_000);
}

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

test('without a run the page says how one comes', async () => {
  await page.goto(`${server.url}/#results/runs`);
  await page.getByText('Each program that ends is kept here').waitFor();
});

test('programs that have ended are found by their name and by their verdict', { timeout: 120_000 }, async () => {
  await execute('spots.ngc', spot('3.3'));
  await execute('deeper.ngc', spot('3.6'));
  await execute('thread.ngc', tap);
  const rows = page.getByRole('region', { name: 'Runs' }).locator('tbody tr');
  await until('three runs are shown', async () => (await rows.count()) === 3);
  assert.match(await rows.first().innerText(), /good[\s\S]*thread\.ngc/);
  await page.getByRole('searchbox').fill('spot');
  await until('one is left', async () => (await rows.count()) === 1);
  assert.match(await rows.first().innerText(), /spots\.ngc/);
  await page.getByLabel('Verdict').selectOption('failed');
  await page.getByText('No run that is kept is like this.').waitFor();
  await page.getByLabel('Verdict').selectOption('');
  await page.getByRole('searchbox').fill('');
  await until('three again', async () => (await rows.count()) === 3);
});

test('a run shows its features, its measures, its traces, and its report with its own script', async () => {
  await page.getByRole('link', { name: 'thread.ngc' }).click();
  const features = page.getByRole('region', { name: 'Run of thread.ngc' });
  await features.locator('tbody tr').nth(1).waitFor();
  await features.locator('tbody tr').first().click();
  await page.getByRole('region', { name: 'Chosen feature' }).getByText('sync error max um').waitFor();
  await page.getByRole('region', { name: 'Traces of the run' }).locator('canvas').first().waitFor();
  await press(page, 'This feature');
  await until('its stretch is shown', async () => !(await page.getByRole('region', { name: 'Traces of the run' }).innerText()).includes('0.000 …'));
  const opened = page.waitForEvent('popup');
  await page.getByRole('link', { name: 'Report' }).click();
  const report = await opened;
  const faults = [];
  report.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
  await report.waitForLoadState();
  assert.match(await report.locator('body').innerText(), /thread\.ngc/);
  assert.deepEqual(faults, []);
  await report.close();
  await page.getByRole('link', { name: 'Certificate' }).waitFor();
});

test('another run is laid over it, feature by feature and trace over trace', async () => {
  await page.getByRole('link', { name: 'spots.ngc' }).click();
  const rows = page.getByRole('region', { name: 'Runs' }).locator('tbody tr', { hasText: 'deeper.ngc' });
  await rows.getByRole('button', { name: 'Lay over' }).click();
  const run = page.getByRole('region', { name: 'Run of spots.ngc' });
  await run.getByText('B is the run of another text').waitFor();
  assert.equal(await run.locator('tbody tr').count(), 2);
  await page.getByText(/B dashed/).waitFor();
  // the address says it: it can be kept and shared
  await page.reload();
  await page.getByRole('region', { name: 'Run of spots.ngc' }).getByText('B is the run of another text').waitFor();
  assert.deepEqual(page.faults, []);
});

test('a tool says how much it has cut, takes a limit, and begins anew', async () => {
  await page.goto(`${server.url}/#offsets`);
  const row = page.locator('tbody tr', { has: page.locator('th', { hasText: /^1$/ }) }).last();
  await until('T1 has cut', async () => /\n?\s*4\b/.test(await row.innerText()));
  await row.getByLabel('T1 At most').fill('4');
  await row.getByLabel('T1 At most').press('Enter');
  await row.getByText('4 of 4').waitFor();
  await row.getByText('at its limit').waitFor();
  await row.getByLabel('T1 At most').fill('4.5');
  await row.getByLabel('T1 At most').press('Enter');
  await page.getByTestId('message').getByText('is no number of holes').waitFor();
  await row.getByLabel('T1 At most').fill('500');
  await row.getByLabel('T1 At most').press('Enter');
  await row.getByText('4 of 500').waitFor();
  await row.getByRole('button', { name: 'New tool T1' }).click({ delay: 800 });
  await row.getByText('0 of 500').waitFor();
  assert.equal((await server.get('tools')).find((tool) => tool.number === 1).life.uses, 0);
});

test('steps are in the unit that is shown', async () => {
  await page.goto(`${server.url}/#machine`);
  await page.evaluate(() => localStorage.setItem('leadscrew.display', JSON.stringify({ unit: 'inch' })));
  await page.reload();
  await page.locator('[data-execution]').waitFor();
  const from = (await server.axis('X')).machine;
  await page.getByRole('tab', { name: 'Jog' }).click();
  await page.getByRole('radio', { name: '0.1', exact: true }).click();
  await page.locator('[data-jog="X-"]').click();
  await until('X has moved by a tenth of an inch', async () => Math.abs((await server.axis('X')).machine - (from - 2.54)) < 0.002);
});
