// The report of a run and the page show the same things in the same colours: theme/colors.css is their home.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const read = (path) => readFileSync(new URL(path, import.meta.url), 'utf8');
/** The custom properties of a rule, by name. */
const properties = (rule) => Object.fromEntries([...rule.matchAll(/--([\w-]+):\s*(#[0-9a-f]+)/gi)].map(([, name, value]) => [name, value.toLowerCase()]));

const page = read('../src/theme/colors.css').split("[data-theme='dark']").map(properties);
const report = read('../../crates/report/src/page/style.css').split('@media (prefers-color-scheme:dark)').map(properties);
// What the report calls each of them, and what the page does.
const shared = { in: ['path-feed', 'signal-1'], out: ['signal-2', 'failed'], second: ['signal-4'] };

for (const [at, theme] of ['light', 'dark'].entries()) {
  test(`report and page draw the same in the same colour, ${theme}`, () => {
    for (const [ofReport, names] of Object.entries(shared)) {
      for (const name of names) assert.equal(report[at][ofReport], page[at][name], `--${ofReport} of the report, --${name} of the page`);
    }
  });
}
