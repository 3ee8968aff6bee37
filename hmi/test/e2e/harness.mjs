// The real server (hmi_fixture_server) and Debian's chromium, one of each per file.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

const kBrowser = process.env.PICKCELL_CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
const kFlags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--host-resolver-rules=MAP cell.test 127.0.0.1'];

/** The program under test; say() sends a command and resolves with what it printed. */
export class FixtureServer {
  static async start() {
    const program = spawn(process.env.PICKCELL_FIXTURE_SERVER, { stdio: ['pipe', 'pipe', 'inherit'] });
    const server = new FixtureServer();
    server.program = program;
    server.lines = createInterface({ input: program.stdout })[Symbol.asyncIterator]();
    const { value } = await server.lines.next();
    server.port = Number(/^ready (\d+)$/.exec(value)[1]);
    server.url = `http://127.0.0.1:${server.port}/`;
    return server;
  }
  async say(command) {
    this.program.stdin.write(command + '\n');
    const printed = [];
    for (;;) {
      const { value, done } = await this.lines.next();
      assert.ok(!done && !value.startsWith('unknown'), `${command}: ${value}`);
      if (value === 'done') return printed;
      printed.push(value);
    }
  }
  freeze() {
    this.program.kill('SIGSTOP');
  }
  thaw() {
    this.program.kill('SIGCONT');
  }
  async end() {
    this.thaw();
    const gone = new Promise((resolve) => this.program.once('exit', resolve));
    this.program.stdin.end();
    await gone;
  }
}

export async function launch() {
  assert.ok(kBrowser, 'chromium is not installed: apt-get install chromium');
  return await chromium.launch({ executablePath: kBrowser, headless: true, args: kFlags });
}

/** A page that is looking at the cell; everything it complains about or asks of other places is in page.troubles. */
export async function open(browser, server, { width = 1280, height = 800, dark = false, query = '?lang=en', url = server.url, reduced = true } = {}) {
  const context = await browser.newContext({
    viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', reducedMotion: reduced ? 'reduce' : 'no-preference', serviceWorkers: 'block',
  });
  const page = await context.newPage();
  page.troubles = [];
  const origin = new URL(url).origin;
  const ofTheTest = (text) => text.includes('willReadFrequently'); // the tests read the canvases back, the page does not
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && !ofTheTest(m.text()) && page.troubles.push(`console: ${m.text()}`));
  page.on('pageerror', (e) => page.troubles.push(`page: ${e.message}`));
  page.on('request', (r) => {
    const u = new URL(r.url());
    if (!['data:', 'blob:'].includes(u.protocol) && u.origin !== origin) page.troubles.push(`request: ${r.url()}`);
  });
  await page.goto(url + query);
  await page.waitForSelector('.page.live');
  return page;
}

/** Publishes pictures until the page has drawn this one or a newer. */
export async function showFrame(page, server, command = 'frame') {
  await server.say(command);
  await page.waitForSelector('.stage:not(.empty)');
}
