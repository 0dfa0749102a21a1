// The document of the API is one that the tools of others take: linted as it is served.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Server } from './helpers.mjs';

const linter = fileURLToPath(new URL('../node_modules/.bin/redocly', import.meta.url));
// The two addresses of sockets have no answer of success: theirs is 101.
const rules = ['--extends', 'recommended', '--skip-rule', 'operation-2xx-response', '--format', 'json'];
let server;
before(async () => { server = await Server.start(); });
after(() => server?.stop());

/** What is found in a document: rule and place. */
function lint(document, name) {
  const path = join(server.folder, name);
  writeFileSync(path, JSON.stringify(document));
  return new Promise((resolve, reject) => {
    const env = { ...process.env, REDOCLY_TELEMETRY: 'off', REDOCLY_SUPPRESS_UPDATE_NOTICE: 'true' };
    execFile(linter, ['lint', path, ...rules], { env, cwd: server.folder }, (_error, out, said) => {
      const begin = out.indexOf('{');
      if (begin < 0) reject(new Error(said));
      else resolve(JSON.parse(out.slice(begin)).problems.map(({ ruleId, location }) => `${ruleId} ${location[0]?.pointer}`));
    });
  });
}

test('the linter of others finds nothing in the document of the API', { timeout: 60_000 }, async () => {
  assert.deepEqual(await lint(await server.get('openapi.json'), 'api.json'), []);
});

test('a document with a mistake does not pass', { timeout: 60_000 }, async () => {
  const document = await server.get('openapi.json');
  delete document.components.schemas.RefusalBody;
  document.paths['/api/v1/status'].get.operationId = document.paths['/api/v1/machine'].get.operationId;
  const found = (await lint(document, 'wrong.json')).join('\n');
  assert.match(found, /no-unresolved-refs/);
  assert.match(found, /operation-operationId-unique/);
});
