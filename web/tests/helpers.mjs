// What the browser tests share: a server of their own, a browser, and the control asked behind the page's back.
import { execFileSync, spawn } from 'node:child_process';
import { cpSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const root = fileURLToPath(new URL('../..', import.meta.url));
export const program = process.env.LEADSCREW ?? join(root, 'target/debug/leadscrew');
const args = [
  '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
  '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
];

/** A control on a port of its own, with folders of its own. */
export class Server {
  static async start(options = []) {
    const server = new Server();
    server.folder = mkdtempSync(join(tmpdir(), 'leadscrew-page-'));
    cpSync(join(root, 'programs'), join(server.folder, 'programs'), { recursive: true });
    server.options = options;
    await server.run('0');
    return server;
  }

  async run(port) {
    const { folder } = this;
    this.child = spawn(program, ['serve', '--port', port, '--programs', join(folder, 'programs'), '--state', join(folder, 'state'), ...this.options], { stdio: ['ignore', 'pipe', 'pipe'] });
    let said = '';
    this.url = await new Promise((resolve, reject) => {
      const read = (data) => {
        said += data;
        const found = /https?:\/\/[\w.:[\]-]+/.exec(said);
        if (found) resolve(found[0]);
      };
      this.child.stdout.on('data', read);
      this.child.stderr.on('data', read);
      this.child.once('exit', (code) => reject(new Error(`the server ended with ${code}: ${said}`)));
    });
    this.port = new URL(this.url).port;
  }

  /** Kills it as a power cut does. */
  async kill() {
    const ended = new Promise((resolve) => this.child.once('exit', resolve));
    this.child.kill('SIGKILL');
    await ended;
  }

  async again() { await this.run(this.port); }

  async get(path) { return (await fetch(`${this.url}/api/v1/${path}`)).json(); }

  status() { return this.get('status'); }

  async axis(letter) { return (await this.status()).axes.find((axis) => axis.letter === letter); }

  async stop() {
    if (this.child.exitCode === null && this.child.signalCode === null) await this.kill();
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/** A machine simulator in a process of its own, which outlives the control. */
export class Machine {
  static async start() {
    const machine = new Machine();
    machine.folder = mkdtempSync(join(tmpdir(), 'leadscrew-machine-'));
    machine.socket = join(machine.folder, 'machine.socket');
    machine.child = spawn(program, ['simulator', '--listen', machine.socket], { stdio: ['ignore', 'pipe', 'pipe'] });
    await new Promise((listens, ended) => {
      machine.child.stdout.once('data', listens);
      machine.child.stderr.once('data', listens);
      machine.child.once('exit', ended);
    });
    return machine;
  }

  /** How it truly is. */
  told() { return JSON.parse(execFileSync(program, ['simulator', '--status', this.socket], { encoding: 'utf8' })); }

  /** The mains fail, and are there again. */
  cutPower() { execFileSync(program, ['simulator', '--power-cut', this.socket]); }

  stop() {
    this.child.kill();
    rmSync(this.folder, { recursive: true, force: true });
  }
}

export const browser = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args });

/** Waits until `is` says yes; says what it waited for when it gives up. */
export async function until(what, is, within_ms = 60_000) {
  const end = Date.now() + within_ms;
  let last;
  while (Date.now() < end) {
    last = await is();
    if (last) return last;
    await new Promise((resolve) => setTimeout(resolve, 40));
  }
  throw new Error(`not within ${within_ms} ms: ${what}`);
}

/** A page on the server that fails the test when its script fails or it asks an outside address. */
export async function open(on, server, { hash = '', ...options } = {}) {
  const context = await on.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(error.message));
  page.on('request', (request) => {
    const { url } = { url: request.url() };
    if (!url.startsWith(server.url) && !url.startsWith('blob:')) page.faults.push(`asked ${url}`);
  });
  page.on('console', (message) => { if (/Content Security Policy/i.test(message.text())) page.faults.push(message.text()); });
  await page.goto(`${server.url}/${hash}`);
  await page.locator('[data-execution]').waitFor();
  return page;
}

export const key = (page, name) => page.getByRole('button', { name, exact: true });

/** Touches a key that can be used: keys say with `aria-disabled` that they cannot. */
export async function press(page, name) {
  const on = key(page, name).first();
  await until(`the key ${name} can be used`, async () => (await on.getAttribute('aria-disabled')) === null);
  await on.click();
}

/** Touches a key whether it can be used or not. */
export const touch = (page, name) => key(page, name).first().click({ force: true });

/** Power on and home, by clicks. */
export async function ready(page, server) {
  await press(page, 'Power on');
  await until('the drives are ready', async () => (await server.status()).is_ready);
  await press(page, 'Home all');
  await until('all axes are homed', async () => (await server.status()).axes.every((axis) => axis.is_homed), 60_000);
}
