// What serving costs and how soon the page knows: memory while the plate is cut, age of the status when it reaches a client,
// and the servo thread without and with twenty viewers and a scope of eight signals. It prints what it measured and judges
// nothing: `node measure/load.mjs [SECONDS]`, on a quiet machine and with a release build (LEADSCREW=…/target/release/leadscrew).
import { readFileSync } from 'node:fs';
import { performance } from 'node:perf_hooks';
import { Server, until } from '../tests/helpers.mjs';

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

function client(scope) {
  const socket = new WebSocket(`${server.url.replace('http', 'ws')}/api/v1/ws`);
  socket.binaryType = 'arraybuffer';
  const seen = { deltas: [], frames: 0, lost: 0, socket };
  socket.onopen = () => { if (scope) socket.send(JSON.stringify({ type: 'scope', signals })); };
  socket.onmessage = ({ data }) => {
    const now = performance.now();
    if (typeof data !== 'string') {
      const length = new DataView(data).getUint32(0, true);
      const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      seen.frames += 1; seen.lost += header.lost_rows;
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'delta' && message.status.time_s !== undefined) seen.deltas.push(now - message.status.time_s * 1000);
  };
  return seen;
}

/** The servo thread over so many seconds: what is counted since its start is told apart by its difference. */
async function watched(what, clients) {
  const pid = server.child.pid;
  const [before, cpu] = [(await server.status()).real_time, processor_s(pid)];
  await sleep(seconds * 1000);
  const [after, spent] = [(await server.status()).real_time, processor_s(pid) - cpu];
  const periods = after.periods - before.periods;
  console.log(`${what}: ${periods} periods, ${((100 * (after.late - before.late)) / periods).toFixed(3)} % late, tick p99.9 ${after.tick_p999_us.toFixed(1)} µs since the start, ` +
    `${resident_MB(pid).toFixed(0)} MB, ${((100 * spent) / seconds).toFixed(0)} % of a core${clients.length ? `, rows of the scope lost ${clients.reduce((all, one) => all + one.lost, 0)}` : ''}`);
}

await ask({ request: 'start' });
const one = client(false);
await watched('one viewer, the plate is cut', []);
// The least age of all is that of a status sent at once over this computer's own network: taken as 0.
const least = Math.min(...one.deltas);
const ages = one.deltas.map((age) => age - least);
console.log(`status, over the least age seen: p50 ${share(ages, 0.5).toFixed(1)} ms, p99 ${share(ages, 0.99).toFixed(1)} ms, of ${ages.length}`);
const viewers = Array.from({ length: 20 }, (_, n) => client(n === 0));
await sleep(1000);
await watched('twenty viewers more, one with a scope of 8 signals', viewers);
for (const viewer of [one, ...viewers]) viewer.socket.close();
await sleep(500);
await watched('none', []);
await server.stop();
