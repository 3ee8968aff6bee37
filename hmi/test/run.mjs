// Every test of the page. The browser tests need PICKCELL_FIXTURE_SERVER (the program hmi_fixture_server) and chromium.
import { spawnSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { root } from './load.mjs';

const of = (folder) => readdirSync(join(root, 'test', folder)).filter((f) => f.endsWith('.test.mjs')).map((f) => join('test', folder, f));
const withBrowser = process.env.PICKCELL_FIXTURE_SERVER !== undefined;
if (!withBrowser) console.error('PICKCELL_FIXTURE_SERVER is not set: the tests in the browser are left out');
const files = [...of('unit'), ...(withBrowser ? of('e2e') : [])];
const run = spawnSync(process.execPath, ['--test', ...files], { cwd: root, stdio: 'inherit' });
process.exit(run.status ?? 1);
