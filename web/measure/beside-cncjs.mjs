// Start, memory, weight of the page and age of the status of `leadscrew serve` and of CNCjs, in turn in one run. It prints what
// it measured and judges nothing. CNCjs is installed anywhere by `npm install cncjs`; its controller is `grbl-line.py` beside
// this file, which answers on a line of its own as Grbl does and says the moment as its position.
//   CNCJS=…/node_modules/.bin/cncjs LEADSCREW=…/target/release/leadscrew node measure/beside-cncjs.mjs [ROUNDS]
import { spawn } from 'node:child_process';
import { readFileSync, rmSync, mkdtempSync } from 'node:fs';
import { createConnection } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { performance } from 'node:perf_hooks';
import { fileURLToPath } from 'node:url';
import { browser, Server, until } from '../tests/helpers.mjs';

const rounds = Number(process.argv[2] ?? 5);
const cncjs = process.env.CNCJS;
if (!cncjs) throw new Error('CNCJS names the program: CNCJS=…/node_modules/.bin/cncjs node measure/beside-cncjs.mjs');
const port = 8764;
const seconds = 5;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const share = (values, of) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(values.length * of))];
const resident_MB = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;
const accepts = (at) => new Promise((resolve) => {
  const socket = createConnection(at, '127.0.0.1', () => { socket.destroy(); resolve(true); });
  socket.once('error', () => resolve(false));
});
async function listening(at, begun) {
  while (!(await accepts(at))) await sleep(2);
  return performance.now() - begun;
}

/** What a page loads until it rests, kB as they were sent. */
async function weight(on, url) {
  const page = await (await on.newContext()).newPage();
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  let bytes = 0;
  session.on('Network.loadingFinished', ({ encodedDataLength }) => (bytes += encodedDataLength));
  await page.goto(url, { waitUntil: 'load' });
  await sleep(3000);
  return { page, kB: bytes / 1000 };
}

/** The ages that the page has seen, ms. */
const ages = (page) => page.evaluate(() => window.ages);

async function ours(on) {
  const begun = performance.now();
  const server = await Server.start(['--real-time']);
  const start_ms = performance.now() - begun;
  await sleep(2000);
  const idle_MB = resident_MB(server.child.pid);
  const { page, kB } = await weight(on, server.url);
  const ask = (body) => fetch(`${server.url}/api/v1/request`, { method: 'POST', body: JSON.stringify(body) });
  await ask({ request: 'power', on: true });
  await until('ready', async () => (await server.status()).is_ready);
  await page.evaluate(() => {
    window.ages = [];
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/api/v1/ws`);
    socket.onmessage = ({ data }) => {
      const message = typeof data === 'string' ? JSON.parse(data) : {};
      if (message.type === 'delta' && message.status.time_s !== undefined) window.ages.push(performance.now() - message.status.time_s * 1000);
    };
  });
  await sleep(seconds * 1000);
  const seen = await ages(page);
  await page.context().close();
  await server.stop();
  // Machine time has another beginning than the page's: the status that was youngest counts as of no age.
  const least = Math.min(...seen);
  return { start_ms, idle_MB, kB, ages: seen.map((age) => age - least) };
}

async function theirs(on) {
  const folder = mkdtempSync(join(tmpdir(), 'cncjs-'));
  const line = spawn('python3', [fileURLToPath(new URL('grbl-line.py', import.meta.url))], { stdio: ['ignore', 'pipe', 'inherit'] });
  const device = await new Promise((resolve) => line.stdout.once('data', (data) => resolve(String(data).trim())));
  const begun = performance.now();
  const child = spawn(cncjs, ['--host', '127.0.0.1', '--port', String(port), '--config', join(folder, 'rc')], { stdio: 'ignore' });
  const start_ms = await listening(port, begun);
  await sleep(2000);
  const idle_MB = resident_MB(child.pid);
  const { page, kB } = await weight(on, `http://127.0.0.1:${port}/`);
  await page.evaluate(async (device) => {
    const signed = await fetch('/api/signin', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ token: '' }) });
    const { token } = await signed.json();
    await new Promise((resolve) => { const script = document.createElement('script'); script.src = '/socket.io/socket.io.js'; script.onload = resolve; document.head.append(script); });
    window.ages = [];
    const socket = window.io.connect('', { query: `token=${token}` });
    // the position that the controller tells is the moment, ms of a day
    socket.on('Grbl:state', ({ status }) => {
      const x = Number(status?.mpos?.x);
      if (x > 0) window.ages.push(((performance.timeOrigin + performance.now()) % 86_400_000) - x);
    });
    socket.on('connect', () => socket.emit('open', device, { controllerType: 'Grbl', baudrate: 115200 }));
  }, device);
  await until('a status comes', async () => (await ages(page)).length > 3, 30_000);
  await page.evaluate(() => (window.ages = []));
  await sleep(seconds * 1000);
  const seen = await ages(page);
  await page.context().close();
  child.kill();
  line.kill();
  rmSync(folder, { recursive: true, force: true });
  return { start_ms, idle_MB, kB, ages: seen };
}

const on = await browser();
const all = { 'leadscrew serve': [], CNCjs: [] };
for (let round = 0; round < rounds; round++) {
  all['leadscrew serve'].push(await ours(on));
  all.CNCjs.push(await theirs(on));
}
await on.close();
for (const [name, runs] of Object.entries(all)) {
  const middle = (field) => share(runs.map((run) => run[field]), 0.5);
  const span = (field, digits = 0) => `${middle(field).toFixed(digits)} (${Math.min(...runs.map((run) => run[field])).toFixed(digits)} to ${Math.max(...runs.map((run) => run[field])).toFixed(digits)})`;
  const aged = runs.flatMap((run) => run.ages);
  console.log(`${name}: listens after ${span('start_ms')} ms, ${span('idle_MB')} MB, page ${span('kB')} kB, ` +
    `status ${(aged.length / rounds / seconds).toFixed(1)} times a second, ${share(aged, 0.5).toFixed(1)} ms old (p50), ${share(aged, 0.99).toFixed(1)} ms (p99)`);
}
