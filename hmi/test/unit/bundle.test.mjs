// The committed bundle is what the sources make, and nothing that was made by this machine alone is in it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readdirSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { root } from '../load.mjs';

const fresh = 'node_modules/.cache-dist-test';
after(() => rmSync(join(root, fresh), { recursive: true, force: true }));

test('dist is up to date', () => {
  const built = spawnSync(process.execPath, ['build.mjs', fresh], { cwd: root, encoding: 'utf8' });
  assert.equal(built.status, 0, built.stderr);
  const names = readdirSync(join(root, fresh)).sort();
  assert.deepEqual(readdirSync(join(root, 'dist')).sort(), names, 'run `npm run build` and commit dist');
  for (const name of names)
    assert.ok(readFileSync(join(root, fresh, name)).equals(readFileSync(join(root, 'dist', name))), `${name}: run \`npm run build\` and commit dist`);
});

test('no other origin, no source map, no API that plain HTTP lacks', () => {
  for (const name of readdirSync(join(root, 'dist'))) {
    const text = readFileSync(join(root, 'dist', name), 'utf8');
    const links = (text.match(/https?:\/\/[^\s"'`)]+/g) ?? []).filter((l) => !l.startsWith('http://www.w3.org/'));
    assert.deepEqual(links, [], name);
    assert.doesNotMatch(text, /sourceMappingURL|randomUUID|crypto\.subtle|serviceWorker|ImageDecoder|VideoDecoder|wakeLock/, name);
  }
  const lock = readFileSync(join(root, 'package-lock.json'), 'utf8');
  assert.doesNotMatch(lock, /"resolved"/, 'the lock file names no registry');
});
