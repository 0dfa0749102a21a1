// Two tabs, and a server that goes and comes back: the page tells the truth.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { browser, key, open, press, Server, touch, until } from './helpers.mjs';

let server; let on; let first; let second;
before(async () => {
  server = await Server.start();
  on = await browser();
  first = await open(on, server);
  second = await open(on, server);
});
after(async () => {
  await on?.close();
  await server?.stop();
});

test('one tab commands, the other sees the same and is told who commands', async () => {
  await press(first, 'Power on');
  await until('the drives are ready', async () => (await server.status()).is_ready);
  await key(second, 'Power off').first().waitFor();
  await press(second, 'Power off');
  await second.getByTestId('message').getByText('commands the machine').waitFor();
  assert.equal((await server.status()).power, 'ON');
});

test('the right to command is asked for and given', async () => {
  await press(second, 'Take over');
  await press(first, 'Give');
  await second.locator('.who').getByText('Take over').waitFor({ state: 'detached' });
  await press(second, 'Power off');
  await until('the second tab has switched off', async () => (await server.status()).power === 'OFF');
});

test('a stop request is had from every tab', async () => {
  await press(first, 'Stop request');
  await until('the chain is open', async () => (await server.status()).emergency_stop === 'TRIGGERED');
  await key(second, 'Release stop').waitFor();
});

test('the server is killed: the page says so and greys what it knew; it comes back: the page shows what is', async () => {
  const powerKey = (await server.status()).power === 'ON' ? 'Power off' : 'Power on';
  await server.kill();
  await first.getByTestId('lost').getByText('No connection to the control').waitFor();
  await first.locator('.dro.old').waitFor();
  await touch(first, powerKey);
  await first.getByTestId('message').getByText('No connection to the control').waitFor();
  await server.again();
  await first.getByTestId('lost').waitFor({ state: 'detached' });
  const { emergency_stop } = await server.status();
  await key(first, emergency_stop === 'TRIGGERED' ? 'Release stop' : 'Stop request').waitFor();
  assert.deepEqual(first.faults, []);
  assert.deepEqual(second.faults, []);
});
