// T10 in the browser: a server that freezes without closing, closes, comes back, comes back with another build.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { root } from '../load.mjs';
import { FixtureServer, launch, open, showFrame } from './harness.mjs';

let server, browser, page;
before(async () => {
  server = await FixtureServer.start();
  browser = await launch();
  page = await open(browser, server);
});
after(async () => {
  await browser?.close();
  await server?.end();
});

const overlayIsClear = () => {
  const c = document.querySelector('canvas.overlay');
  return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.every((v) => v === 0);
};

test('a frozen server: the page is visibly dead, keeps only Stop, and comes back by itself', async () => {
  await showFrame(page, server);
  assert.equal(await page.evaluate(overlayIsClear), false);
  server.freeze();
  await page.waitForSelector('.page.dead', { timeout: 15000 });
  assert.match(await page.textContent('.dead-banner'), /No contact with the cell for \d+ s/);
  assert.equal(await page.evaluate(overlayIsClear), true);
  assert.equal(await page.locator('.start').isDisabled(), true);
  assert.equal(await page.locator('.reset').isDisabled(), true);
  assert.equal(await page.locator('.stop').isDisabled(), false);
  const hatch = await page.evaluate(() => [...document.querySelectorAll('.panel')].every((p) => getComputedStyle(p, '::after').backgroundImage.includes('repeating-linear-gradient')));
  assert.equal(hatch, true, 'every panel is hatched');
  server.thaw();
  await page.waitForSelector('.page.live', { timeout: 15000 });
  await server.say('counter placed 5');
  await page.waitForFunction(() => document.querySelector('[data-counter=placed]').textContent === '5');
  await server.say('frame');
  await page.waitForFunction(() => document.querySelectorAll('.part').length === 1);
});

test('a server that is gone and back with another page: live again, and a hint to reload', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'pickcell-hmi-'));
  try {
    cpSync(join(root, 'dist'), folder, { recursive: true });
    const manifest = JSON.parse(readFileSync(join(folder, 'manifest.json')));
    writeFileSync(join(folder, 'manifest.json'), JSON.stringify({ ...manifest, build: 'ffffffffffffffff' }));
    assert.equal(await page.locator('.reload').count(), 0);
    await server.say('stop');
    await page.waitForSelector('.page.dead', { timeout: 15000 });
    await server.say(`root ${folder}`);
    await page.waitForSelector('.page.live', { timeout: 15000 });
    await page.waitForSelector('.reload');
  } finally {
    rmSync(folder, { recursive: true });
  }
});
