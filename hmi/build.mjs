// Bundles src/ into dist/: hashed names, no source maps, nothing that depends on the machine, the date or the Node version.
// The result is committed; CI rebuilds it and compares.
import { createHash } from 'node:crypto';
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const root = dirname(fileURLToPath(import.meta.url));
const sha = (data) => createHash('sha256').update(data).digest('hex');

function filesOf(folder) {
  return readdirSync(folder, { withFileTypes: true })
    .flatMap((e) => (e.isDirectory() ? filesOf(join(folder, e.name)) : [join(folder, e.name)]))
    .sort();
}

/** One hash over everything the page is made of; the page and the server compare it. */
function sourceHash() {
  const inputs = [...filesOf(join(root, 'src')), ...['index.html', 'build.mjs', 'package-lock.json'].map((f) => join(root, f))];
  return sha(inputs.map((f) => `${relative(root, f)} ${sha(readFileSync(f))}\n`).join('')).slice(0, 16);
}

const dist = join(root, process.argv[2] ?? 'dist');
const hash = sourceHash();
const banner = '/* pickcell HMI, Apache-2.0. Contains preact and @preact/signals: MIT, Copyright (c) 2015-present Jason Miller, 2022-present Preact Team */';
const result = await build({
  absWorkingDir: root,
  entryPoints: { app: 'src/main.tsx' },
  outdir: dist,
  entryNames: '[name]-[hash]',
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2021',
  charset: 'utf8',
  legalComments: 'none',
  banner: { js: banner },
  define: { BUILD_HASH: JSON.stringify(hash) },
  metafile: true,
  write: false,
});

rmSync(dist, { recursive: true, force: true });
mkdirSync(dist, { recursive: true });
const names = {};
const files = [];
function put(name, data, immutable) {
  writeFileSync(join(dist, name), data);
  files.push({ path: name, immutable });
}
for (const out of result.outputFiles) {
  const name = relative(dist, out.path);
  names[name.endsWith('.css') ? 'CSS' : 'JS'] = name;
  put(name, out.contents, true);
}
const icon = readFileSync(join(root, 'src/icon.svg'));
names.ICON = `icon-${sha(icon).slice(0, 8)}.svg`;
put(names.ICON, icon, true);
const page = readFileSync(join(root, 'index.html'), 'utf8').replace(/@(\w+)@/g, (_, key) => names[key]);
put('index.html', page, false);
files.sort((a, b) => (a.path < b.path ? -1 : 1));
writeFileSync(join(dist, 'manifest.json'), JSON.stringify({ build: hash, files }, null, 1) + '\n');
const sizes = files.map((f) => `${f.path} ${(readFileSync(join(dist, f.path)).length / 1000).toFixed(1)} kB`);
console.log(`build ${hash}: ${sizes.join(', ')}`);
