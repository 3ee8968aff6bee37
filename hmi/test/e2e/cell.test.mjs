// T20: the whole simulated cell behind the page: Start, some parts placed, Stop; the page's counters are the journal's.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { launch, open } from './harness.mjs';

const program = process.env.PICKCELL_BINARY;
const kParts = 2;
const kLong = { timeout: 90000 };

/** How many commands journal.db holds in each state. */
function journal(folder) {
  const code = `
import json, pathlib, sqlite3, sys
[file] = pathlib.Path(sys.argv[1]).rglob("journal.db")
print(json.dumps(dict(sqlite3.connect(file).execute("SELECT state, count(*) FROM cmd GROUP BY state"))))`;
  const ran = spawnSync('python3', ['-c', code, folder], { encoding: 'utf8' });
  assert.equal(ran.status, 0, ran.stderr);
  return JSON.parse(ran.stdout);
}

let cell, browser, folder, url;
before(async () => {
  if (!program) return;
  folder = mkdtempSync(join(tmpdir(), 'pickcell-cell-'));
  cell = spawn(program, ['start', '--listen', '127.0.0.1:0', '--seed', '5'], {
    stdio: ['ignore', 'inherit', 'pipe'], env: { ...process.env, XDG_STATE_HOME: folder },
  });
  for await (const line of createInterface({ input: cell.stderr })) {
    url = /ready at (http\S+)/.exec(line)?.[1];
    if (url) break;
  }
  assert.ok(url, 'the cell said where its page is');
  cell.stderr.resume();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await end();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

async function end() {
  if (!cell || cell.exitCode !== null) return;
  const gone = new Promise((resolve) => cell.once('exit', resolve));
  cell.kill('SIGINT');
  await gone;
}

test('start, parts placed, stop: the page shows what the journal holds', { skip: program ? false : 'PICKCELL_BINARY is not set' }, async () => {
  const page = await open(browser, { url }, {});
  const counter = (name) => page.evaluate((n) => Number(document.querySelector(`[data-counter=${n}]`).textContent), name);
  await page.waitForSelector('[data-mode=idle]', kLong);
  await page.locator('.start').focus();
  await page.keyboard.down(' ');
  await page.waitForSelector('[data-mode=running]', kLong);
  await page.keyboard.up(' ');
  await page.waitForFunction((n) => Number(document.querySelector('[data-counter=placed]').textContent) >= n, kParts, kLong);
  await page.waitForFunction(() => document.querySelectorAll('.part').length > 0, null, kLong);
  if (process.env.PICKCELL_SCREENSHOTS) await page.screenshot({ path: join(process.env.PICKCELL_SCREENSHOTS, 'cell.png') });
  await page.locator('.stop').click();
  await page.waitForSelector('[data-mode=idle]', kLong);
  const [submitted, placed, missed, unknown] = await Promise.all(['submitted', 'placed', 'missed', 'unknown'].map(counter));
  const state = await (await fetch(`${url}api/v1/state`)).json();
  assert.equal(state.data.counters.placed, placed);
  assert.deepEqual(page.troubles, []);
  await end(); // the journal is the cell's alone while it runs
  const kept = journal(folder);
  assert.ok(placed >= kParts);
  assert.equal(kept.done ?? 0, placed);
  assert.equal(kept.refused ?? 0, missed);
  assert.equal(kept.unknown ?? 0, unknown);
  assert.equal(Object.values(kept).reduce((sum, n) => sum + n, 0), submitted);
});
