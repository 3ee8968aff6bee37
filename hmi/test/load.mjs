// The page's own modules for tests: bundled from TypeScript on the fly, so that tests run on any Node from 18 on.
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { build } from 'esbuild';

export const root = dirname(dirname(fileURLToPath(import.meta.url)));

export async function load(module) {
  const folder = mkdtempSync(join(tmpdir(), 'pickcell-hmi-'));
  const outfile = join(folder, 'module.mjs');
  try {
    await build({ absWorkingDir: root, entryPoints: [join('src', module)], outfile, bundle: true, format: 'esm', logLevel: 'error' });
    return await import(pathToFileURL(outfile));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** A clock that moves when told: later() as the page's modules take it, advance() for the test. */
export class FakeTime {
  now = 0;
  #timers = [];
  later = (callback, ms) => void this.#timers.push({ at: this.now + ms, callback });
  advance(ms) {
    const end = this.now + ms;
    for (;;) {
      const next = this.#timers.filter((t) => t.at <= end).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      this.#timers.splice(this.#timers.indexOf(next), 1);
      this.now = next.at;
      next.callback();
    }
    this.now = end;
  }
}

/** Reproducible numbers, [0, 1). */
export function random(seed) {
  let s = seed >>> 0;
  return () => {
    s = (s + 0x6d2b79f5) >>> 0;
    let t = Math.imul(s ^ (s >>> 15), s | 1);
    t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
