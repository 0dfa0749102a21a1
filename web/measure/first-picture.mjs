// How long it takes from `leadscrew serve` to the first complete picture in a browser that is open already. It prints what it
// measured and judges nothing: `node measure/first-picture.mjs [ROUNDS]`, on a quiet machine and with a release build
// (LEADSCREW=…/target/release/leadscrew).
import { performance } from 'node:perf_hooks';
import { browser, Server, until } from '../tests/helpers.mjs';

const rounds = Number(process.argv[2] ?? 5);
const on = await browser();
// The browser's own start is no part of it.
await (await on.newPage()).goto('about:blank');

/** When each part was there, ms after `since` (of the clock that began with 1970). */
async function seen(page, since) {
  await page.waitForFunction(() => performance.getEntriesByName('picture').length > 0 && performance.getEntriesByName('digits').length > 0);
  const at = await page.evaluate(() => {
    const mark = (name) => performance.getEntriesByName(name)[0]?.startTime ?? NaN;
    const asked = performance.getEntriesByType('resource');
    const bytes = asked.reduce((all, entry) => all + entry.transferSize, 0);
    return { origin: performance.timeOrigin, paint: mark('first-contentful-paint'), digits: mark('digits'), picture: mark('picture'), bytes };
  });
  const after = (ms) => at.origin + ms - since;
  return { asked: after(0), paint: after(at.paint), digits: after(at.digits), complete: after(Math.max(at.digits, at.picture)), kB: at.bytes / 1000 };
}

const rows = { 'from the start of the server': [], 'a reload with a program loaded': [] };
for (let round = 0; round < rounds; round++) {
  const context = await on.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  const begun = performance.timeOrigin + performance.now();
  const server = await Server.start();
  const listening = performance.timeOrigin + performance.now() - begun;
  await page.goto(server.url);
  rows['from the start of the server'].push({ listening, ...(await seen(page, begun)) });
  const load = { method: 'POST', body: JSON.stringify({ request: 'load', program: 'plate-12xM6.ngc' }) };
  await fetch(`${server.url}/api/v1/request`, load);
  await until('the program is loaded', async () => (await server.status()).program !== null);
  const again = performance.timeOrigin + performance.now();
  await page.goto('about:blank');
  await page.goto(server.url);
  rows['a reload with a program loaded'].push(await seen(page, again));
  await context.close();
  await server.stop();
}
await on.close();

const middle = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
for (const [what, all] of Object.entries(rows)) {
  const parts = Object.keys(all[0]).map((name) => {
    const values = all.map((row) => row[name]);
    return `${name} ${middle(values).toFixed(0)} (${Math.min(...values).toFixed(0)} to ${Math.max(...values).toFixed(0)})`;
  });
  console.log(`${what}, ms, middle of ${rounds} (least to most): ${parts.join(', ')}`);
}
