// What can be measured of the look: accessibility by axe, sizes of targets, nothing outside the screen.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { FixtureServer, launch, open, showFrame } from './harness.mjs';

const kAxe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const kTags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
// Reviewed: what axe cannot judge by itself.
const kReviewed = {
  'color-contrast': 'text under the hatch of a dead page or beside a pseudo-element: judged on the same tokens without it',
};

let server, browser;
before(async () => {
  server = await FixtureServer.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.end();
});

/** By CDP, because the page's policy lets no script in. */
async function axe(page) {
  const cdp = await page.context().newCDPSession(page);
  const run = async (expression) => {
    const { result, exceptionDetails } = await cdp.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    assert.equal(exceptionDetails, undefined, JSON.stringify(exceptionDetails));
    return result.value;
  };
  await run(`${kAxe}; undefined`);
  const text = await run(`axe.run(document, { runOnly: ${JSON.stringify(kTags)}, resultTypes: ['violations', 'incomplete'] })
    .then((r) => JSON.stringify({ violations: r.violations, incomplete: r.incomplete }))`);
  await cdp.detach();
  const { violations, incomplete } = JSON.parse(text);
  const short = (list) => list.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.target.join(' ')}: ${n.any?.[0]?.message ?? v.help}`));
  return { violations: short(violations), incomplete: incomplete.filter((i) => !(i.id in kReviewed)).map((i) => `${i.id}: ${short([i])}`) };
}

async function shoot(page, name) {
  if (!process.env.PICKCELL_SCREENSHOTS) return;
  mkdirSync(process.env.PICKCELL_SCREENSHOTS, { recursive: true });
  await page.screenshot({ path: join(process.env.PICKCELL_SCREENSHOTS, `${name}.png`) });
}

async function fill() {
  for (const line of ['clear', 'counter placed 128', 'counter missed 2', 'reject score 5', 'reject overlap 3', 'log info looking',
    'log info picture 31: 7 parts, 1 turned down', 'log warning part 6: another part lies 3 mm beside the grasp', 'log info part 50 placed in slot 12'])
    await server.say(line);
}

const kStates = {
  normal: async (page) => showFrame(page, server, 'parts'),
  alarm: async (page) => {
    await server.say('fault The robot stopped with an alarm.');
    await server.say('alarm 1 Robot alarm 4107: out of range');
    await server.say('alarm 2 The belt stands still');
    await server.say('alarm 3 Few parts in the feeder');
    await server.say('alarm 3 Lens should be cleaned');
    await showFrame(page, server, 'parts');
    await page.waitForSelector('.alarm.active.p1');
  },
  details: async (page) => {
    await showFrame(page, server, 'parts');
    await page.waitForFunction(() => document.querySelectorAll('.part').length === 7);
    await page.locator('.part').last().click();
    await page.waitForSelector('.part-details .why');
  },
  dead: async (page) => {
    await showFrame(page, server, 'parts');
    server.freeze();
    await page.waitForSelector('.page.dead', { timeout: 15000 });
  },
};

for (const [state, bring] of Object.entries(kStates))
  test(`axe finds nothing: ${state}, light and dark`, async () => {
    await fill();
    const pages = [];
    for (const dark of [false, true]) pages.push(await open(browser, server, { dark }));
    try {
      for (const [i, page] of pages.entries()) {
        server.thaw();
        await bring(page);
        await shoot(page, `${state}-${i ? 'dark' : 'light'}`);
        const { violations, incomplete } = await axe(page);
        assert.deepEqual(violations, []);
        assert.deepEqual(incomplete, []);
        assert.deepEqual(page.troubles.filter((t) => state !== 'dead' || !t.includes('WebSocket')), []);
      }
    } finally {
      server.thaw();
      for (const page of pages) await page.context().close();
    }
  });

test('axe would find grey on grey', async () => {
  const page = await open(browser, server);
  await page.evaluate(() => {
    const p = document.createElement('p');
    p.textContent = 'hardly readable text';
    p.style.color = '#9a9c9e';
    document.querySelector('.log').append(p);
  });
  const { violations } = await axe(page);
  assert.ok(violations.some((v) => v.startsWith('color-contrast')), violations.join('\n'));
  await page.context().close();
});

for (const [width, height] of [[1280, 800], [1024, 768], [1920, 1080], [390, 844]])
  test(`targets and edges at ${width}x${height}`, async () => {
    await fill();
    await server.say('alarm 2 The belt stands still');
    const page = await open(browser, server, { width, height });
    await showFrame(page, server, 'parts');
    await page.waitForFunction(() => document.querySelectorAll('.part').length === 7);
    await shoot(page, `size-${width}`);
    const found = await page.evaluate(() => {
      const targets = [...document.querySelectorAll('button, summary, a, input, select')].map((e) => {
        const r = e.getBoundingClientRect();
        return { name: e.className || e.tagName, w: r.width, h: r.height, left: r.left, right: r.right, top: r.top, bottom: r.bottom, bar: !!e.closest('.actions') };
      });
      return { targets, scroll: document.documentElement.scrollWidth, scrollY: document.documentElement.scrollHeight };
    });
    assert.ok(found.targets.length > 8);
    assert.ok(found.scroll <= width, `horizontal scroll: ${found.scroll}`);
    for (const t of found.targets) {
      assert.ok(t.w >= 48 && t.h >= 47.9, `${t.name} is ${t.w} x ${t.h}`);
      if (t.bar) {
        assert.ok(t.h >= 56, `${t.name} is ${t.h} high`);
        assert.ok(t.left >= 0 && t.right <= width && t.top >= 0 && t.bottom <= height, `${t.name} is outside the screen`);
      }
    }
    const bar = found.targets.filter((t) => t.bar).sort((a, b) => a.left - b.left);
    for (let i = 1; i < bar.length; ++i) assert.ok(bar[i].left - bar[i - 1].right >= 8, 'room between the buttons');
    if (width >= 1024) assert.ok(found.scrollY <= height, `vertical scroll: ${found.scrollY}`);
    assert.deepEqual(page.troubles, []);
    await page.context().close();
  });
