// What serving costs and how soon the page knows: memory while the plate is cut, age of the status when it reaches a client,
// and the servo thread without and with twenty viewers and a scope of eight signals. It prints what it measured and judges
// nothing: `node measure/load.mjs [SECONDS]`, on a quiet machine and with a release build (LEADSCREW=…/target/release/leadscrew).
import { readFileSync } from 'node:fs';
import { performance } from 'node:perf_hooks';
import { browser, Server, until } from '../tests/helpers.mjs';

const seconds = Number(process.argv[2] ?? 15);
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const share = (values, of) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(values.length * of))];
const resident_MB = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;
const processor_s = (pid) => { const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' '); return (Number(fields[11]) + Number(fields[12])) / 100; };

const server = await Server.start(['--real-time']);
const ask = async (body) => {
  const answer = await (await fetch(`${server.url}/api/v1/request`, { method: 'POST', body: JSON.stringify(body) })).json();
  if (!answer.accepted) throw new Error(JSON.stringify(answer));
};
await ask({ request: 'power', on: true });
await until('ready', async () => (await server.status()).is_ready);
await ask({ request: 'home' });
await until('homed', async () => (await server.status()).axes.every((axis) => axis.is_homed), 60_000);
await ask({ request: 'load', program: 'plate-12xM6.ngc' });
const signals = (await server.get('machine')).signals.slice(0, 8);

const on = await browser();
const page = await (await on.newContext()).newPage();
await page.goto(`${server.url}/#alarms`);

/** Opens so many sockets within the page; the first has a scope if asked. What they saw is kept by the page. */
const connect = (count, scope) => page.evaluate(({ count, scope }) => {
  window.seen ??= [];
  for (let n = 0; n < count; n++) {
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/api/v1/ws`);
    socket.binaryType = 'arraybuffer';
    const seen = { ages: [], frames: 0, lost: 0, socket };
    socket.onopen = () => { if (scope && n === 0) socket.send(JSON.stringify({ type: 'scope', signals: scope })); };
    socket.onmessage = ({ data }) => {
      if (typeof data !== 'string') {
        const length = new DataView(data).getUint32(0, true);
        seen.frames += 1;
        seen.lost += JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length))).lost_rows;
        return;
      }
      const message = JSON.parse(data);
      if (message.type === 'delta' && message.status.time_s !== undefined) seen.ages.push(performance.now() - message.status.time_s * 1000);
    };
    window.seen.push(seen);
  }
}, { count, scope });
const look = () => page.evaluate(() => window.seen.map(({ ages, frames, lost }) => ({ ages, frames, lost })));
const close = () => page.evaluate(() => { window.seen.forEach(({ socket }) => socket.close()); window.seen = []; });

/** The servo thread over so many seconds: what is counted since its start is told apart by its difference. */
async function watched(what) {
  const pid = server.child.pid;
  const [before, cpu] = [(await server.status()).real_time, processor_s(pid)];
  await sleep(seconds * 1000);
  const [after, spent] = [(await server.status()).real_time, processor_s(pid) - cpu];
  const periods = after.periods - before.periods;
  console.log(`${what}: ${periods} periods, ${((100 * (after.late - before.late)) / periods).toFixed(3)} % late, tick p99.9 ${after.tick_p999_us.toFixed(1)} µs since the start, ` +
    `${resident_MB(pid).toFixed(0)} MB, ${((100 * spent) / seconds).toFixed(0)} % of a core`);
}

await ask({ request: 'start' });
await connect(1, null);
await watched('one page and one viewer, the plate is cut');
// The least age of all is that of a status sent at once over this computer's own network: taken as 0.
const [{ ages }] = await look();
const least = Math.min(...ages);
console.log(`status in the page, over the least age seen: p50 ${(share(ages, 0.5) - least).toFixed(1)} ms, p99 ${(share(ages, 0.99) - least).toFixed(1)} ms, of ${ages.length}`);
await connect(20, signals);
await watched('twenty viewers more, one with a scope of 8 signals');
const scope = (await look())[1];
console.log(`the scope: ${scope.frames} frames, ${scope.lost} rows lost`);
await close();
await watched('one page alone again');
await on.close();
await server.stop();
