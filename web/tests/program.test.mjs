// The page Program: what the language server finds on this machine, what mends it, outline, time, completion, hover.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, key, open, press, ready, Server, until } from './helpers.mjs';

let server; let on; let page;
before(async () => {
  server = await Server.start();
  on = await browser();
  page = await open(on, server, { hash: '#program' });
});
after(async () => {
  await on?.close();
  await server?.stop();
});

const content = () => page.locator('.editor .cm-content');
const text = async () => (await page.locator('.editor .cm-line').allTextContents()).join('\n');
const finding = (code) => page.getByRole('region', { name: 'Findings' }).locator('li').filter({ hasText: code });

async function write(program) {
  await content().click();
  await page.keyboard.press('ControlOrMeta+a');
  await page.keyboard.press('Delete');
  await page.keyboard.type(program);
}

test('a feed that this machine cannot is found while it is typed, and a touch writes the one that works', async () => {
  await write('G21 G90 G94\nS500 M3\nG1 X20 F60000\nM2\n');
  const found = finding('M0304');
  await found.getByText('Line 3').waitFor();
  await press(page, 'Write F30000, line 3');
  await until('the finding is gone', async () => (await found.count()) === 0);
  assert.match(await text(), /G1 X20 F30000\nM2/);
  await until('the time is known', async () => /planned 00:0\d/.test(await page.getByTestId('planned').textContent()));
  assert.deepEqual(page.faults, []);
});

test('an offset that is set makes findings, and setting it back takes them away', async () => {
  await ready(page, server);
  await write('G21 G90 G54\nG0 X100\nM2\n');
  await page.getByText('Nothing was found').waitFor();
  const shift = (at_mm) => page.evaluate(async (at) => {
    const { session } = JSON.parse(sessionStorage.getItem('leadscrew.session'));
    const body = JSON.stringify({ request: 'set_work_offset', work_offset: 'G54', axis: 'X', at_mm: at });
    return (await fetch('/api/v1/request', { method: 'POST', headers: { 'content-type': 'application/json', 'x-leadscrew-session': session }, body })).ok;
  }, at_mm);
  assert.ok(await shift(-50));
  await finding('M0301').getByText('Line 2').waitFor();
  assert.ok(await shift(-250));
  await page.getByText('Nothing was found').waitFor();
});

test('a code is completed with Tab, and Enter begins a line', async () => {
  await write('G21\nG8');
  const list = page.locator('.cm-tooltip-autocomplete');
  await list.getByText('right-hand tapping').first().waitFor();
  await page.keyboard.type('4');
  await until('it is the first', async () => /^G84/.test(await list.locator('li[aria-selected]').textContent()));
  await page.waitForTimeout(100); // the list takes no key sooner than 75 ms after it has changed
  await page.keyboard.press('Tab');
  await page.keyboard.type(' Z-5\nM3');
  await page.keyboard.press('Enter');
  await page.keyboard.type('M2');
  assert.equal(await text(), 'G21\nG84 Z-5\nM3\nM2');
  await page.keyboard.press('Escape');
});

test('outline, and what a word does', async () => {
  await page.getByRole('button', { name: /^plate-12xM6\.ngc/ }).click();
  const outline = page.locator('.outline');
  await outline.getByText('T3').waitFor();
  await outline.getByRole('button', { name: /^T3/ }).click();
  await until('its line is chosen', async () => /T3/.test(await page.locator('.editor .cm-activeLine').textContent()));
  await page.locator('.editor .cm-line', { hasText: 'G84' }).first().locator('span', { hasText: 'G84' }).hover();
  await page.locator('.cm-lsp-hover-tooltip').getByText('right-hand tapping').waitFor();
  assert.ok(await page.locator('.cm-lsp-hover-tooltip table').isVisible());
  await page.mouse.move(0, 0);
  assert.deepEqual(page.faults, []);
});

test('a file is uploaded by choosing it, and by dropping it', async () => {
  const upload = page.getByLabel('Upload a file');
  await upload.setInputFiles({ name: 'chosen.ngc', mimeType: 'text/plain', buffer: Buffer.from('G21\nG0 X1\nM2\n') });
  await until('it is shown', async () => /G0 X1/.test(await text()));
  const drop = (name, content) => page.locator('.program').evaluate((on, [name, content]) => {
    const data = new DataTransfer();
    data.items.add(new File([content], name, { type: 'text/plain' }));
    on.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
  }, [name, content]);
  await drop('dropped.ngc', 'G21\nG0 X2\nM2\n');
  await until('it is shown', async () => /G0 X2/.test(await text()));
  const names = (await server.get('programs')).programs.map(({ path }) => path);
  assert.ok(names.includes('chosen.ngc') && names.includes('dropped.ngc'), names.join());
  // what is no name within the folder is refused in a sentence, and the text stays
  await drop('..', 'M2\n');
  await page.getByTestId('message').waitFor();
  assert.match(await text(), /G0 X2/);
  assert.deepEqual(page.faults, []);
});

test('the server is killed and started again: the editor is told of the text as it is', async () => {
  await server.kill();
  await write('G21 G90\nG0 X900\nM2\n');
  await server.again();
  await finding('M0301').getByText('Line 2').waitFor();
  await key(page, 'Save').waitFor();
});

test('a program whose words are another dialect\'s is read as one for it with a touch, loaded so, and read as the machine does again', async () => {
  await page.getByRole('button', { name: /^plate-macro\.nc/ }).click();
  const found = finding('I0909');
  await found.waitFor();
  assert.ok(!/--dialect/.test(await found.textContent()), 'in the page\'s words');
  if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/read-as.png` });
  await press(page, 'Read it as one for Fanuc\'s machining centres');
  await until('the finding is gone', async () => (await found.count()) === 0);
  await page.getByText('read as one for Fanuc\'s machining centres').waitFor();
  if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/is-read-as.png` });
  await press(page, 'Load');
  await page.getByText('plate-macro.nc is loaded').first().waitFor();
  await press(page, 'Read it as the machine does');
  await found.waitFor();
  assert.deepEqual(page.faults, []);
});
