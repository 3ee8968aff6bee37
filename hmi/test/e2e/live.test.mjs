// The live picture: overlay and picture belong together, one frame at a time, and the rest of the page's conduct.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { FixtureServer, launch, open, showFrame } from './harness.mjs';

let server, browser;
before(async () => {
  server = await FixtureServer.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.end();
});

/** What is on the two canvases at this moment: the number in the picture, and where the overlay's first centre is. */
const look = () => {
  const picture = document.querySelector('canvas.picture');
  const overlay = document.querySelector('canvas.overlay');
  const pixels = picture.getContext('2d').getImageData(0, 0, picture.width, picture.height).data;
  const bit = (picture.width / 640) * 32;
  let number = 0;
  for (let i = 0; i < 16; ++i) {
    const at = (Math.round(bit / 2) * picture.width + Math.round((i + 0.5) * bit)) * 4;
    if (pixels[at] > 128) number |= 1 << i;
  }
  // The part's outline encloses a rectangle of 91 x 45 sensor pixels: the middle of everything drawn above the label.
  const drawn = overlay.getContext('2d').getImageData(0, 0, overlay.width, overlay.height).data;
  const scale = overlay.width / 640;
  const at = (x, y) => drawn[(Math.round((y + 0.5) * scale) * overlay.width + Math.round((x + 0.5) * scale)) * 4 + 3] > 0;
  const place = [100 + ((number * 37) % 440), 120 + ((number * 53) % 330)];
  const corners = [[-45.5, -22.5], [45.5, -22.5], [45.5, 22.5], [-45.5, 22.5]];
  return { number, agrees: number === 0 || (at(...place) && corners.every(([dx, dy]) => at(place[0] + dx, place[1] + dy))) };
};

test('the overlay on the screen is always that of the picture on the screen', async () => {
  const page = await open(browser, server);
  await showFrame(page, server);
  const seen = new Set();
  for (let i = 0; i < 60; ++i) {
    await server.say('frame');
    const { number, agrees } = await page.evaluate(look);
    assert.ok(agrees, `picture ${number} without its overlay`);
    seen.add(number);
  }
  assert.ok(seen.size > 5, `${seen.size} different pictures were seen`);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test('the check above can fail: an overlay moved by 12 pixels is noticed', async () => {
  const page = await open(browser, server);
  await showFrame(page, server);
  assert.ok((await page.evaluate(look)).agrees);
  await page.evaluate(() => {
    const overlay = document.querySelector('canvas.overlay');
    const copy = document.createElement('canvas');
    copy.width = overlay.width;
    copy.height = overlay.height;
    copy.getContext('2d').drawImage(overlay, 0, 0);
    const ctx = overlay.getContext('2d');
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, overlay.width, overlay.height);
    ctx.drawImage(copy, 12, 12);
  });
  assert.equal((await page.evaluate(look)).agrees, false);
  await page.context().close();
});

test('a page whose scripts hang gets one frame, then the newest; the cell and other pages go on', async () => {
  const slow = await open(browser, server);
  const brisk = await open(browser, server);
  await showFrame(slow, server);
  await showFrame(brisk, server);
  const shown = (page) => page.evaluate(() => Number(document.querySelector('.live .aside')?.textContent?.match(/#(\d+)/)?.[1] ?? 0));
  await slow.evaluate(() => {
    window.goOn = false;
    // The page draws nothing until it is let go: its decoder waits.
    const real = window.createImageBitmap.bind(window);
    window.createImageBitmap = (...args) => new Promise((resolve) => {
      const wait = () => (window.goOn ? resolve(real(...args)) : setTimeout(wait, 10));
      wait();
    });
  });
  const before = await shown(slow);
  let last = before;
  for (let i = 0; i < 40; ++i) {
    await server.say('frame');
    last = Math.max(last, await shown(brisk));
  }
  assert.ok(last > before + 5, 'the other page went on');
  const held = await shown(slow);
  assert.ok(held <= before + 1);
  const arrived = [];
  await slow.exposeFunction('arrivedFrame', (n) => arrived.push(n));
  await slow.evaluate(() => {
    new MutationObserver(() => {
      const n = Number(document.querySelector('.live .aside')?.textContent?.match(/#(\d+)/)?.[1] ?? 0);
      window.arrivedFrame(n);
    }).observe(document.querySelector('.live'), { subtree: true, childList: true, characterData: true });
    window.goOn = true;
  });
  await slow.waitForFunction((n) => Number(document.querySelector('.live .aside')?.textContent?.match(/#(\d+)/)?.[1] ?? 0) >= n, last);
  const distinct = [...new Set(arrived.filter((n) => n > held))]; // the frame it hung on, then the newest
  assert.ok(distinct.length <= 2, `${distinct.length} frames had piled up: ${distinct}`);
  await slow.context().close();
  await brisk.context().close();
});

test('a tap on a part shows what it is and why it is not picked; the list does the same by keyboard', async () => {
  const page = await open(browser, server);
  await showFrame(page, server, 'parts');
  await page.waitForFunction(() => document.querySelectorAll('.part').length === 7);
  const box = await page.locator('.stage').boundingBox();
  const scale = box.width / 640;
  await page.mouse.click(box.x + (90 + 5 * 92) * scale, box.y + 440 * scale);
  await page.waitForSelector('.part-details .why');
  assert.match(await page.textContent('.part-details'), /another part lies 3 mm beside the grasp/);
  await page.mouse.click(box.x + 20 * scale, box.y + 60 * scale);
  await page.waitForSelector('.part-list');
  await page.locator('.part').nth(3).focus();
  await page.keyboard.press('Enter');
  await page.waitForSelector('.part-details');
  assert.match(await page.textContent('.part-details'), /placed/);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test('start needs 0.8 s of holding, stop acts on the press; both arrive once', async () => {
  const page = await open(browser, server);
  const count = async (name) => Number((await server.say(`commands ${name}`))[0].split(' ')[1]);
  const starts = await count('start');
  const hover = async (selector) => {
    const b = await page.locator(selector).boundingBox();
    await page.mouse.move(b.x + b.width / 2, b.y + b.height / 2);
  };
  await hover('.start');
  await page.mouse.down();
  await page.mouse.up();
  assert.equal(await count('start'), starts);
  await page.mouse.down();
  await page.waitForSelector('[data-mode=running]');
  await page.mouse.up();
  assert.equal(await count('start'), starts + 1);
  const stops = await count('stop');
  await hover('.stop');
  await page.mouse.down();
  await page.waitForSelector('[data-mode=idle]');
  await page.mouse.up();
  assert.equal(await count('stop'), stops + 1);
  await page.locator('.start').focus();
  await page.keyboard.down(' ');
  await page.waitForSelector('[data-mode=running]');
  await page.keyboard.up(' ');
  await page.locator('.stop').focus();
  await page.keyboard.press('Enter');
  await page.waitForSelector('[data-mode=idle]');
  assert.equal(await count('stop'), stops + 2);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test('a fault says why; reset leads back; the log and the counters follow', async () => {
  const page = await open(browser, server);
  await server.say('fault The controller does not answer.');
  await page.waitForSelector('[data-mode=fault]');
  assert.match(await page.textContent('.banners'), /The controller does not answer\. Look at the robot, then reset\./);
  assert.equal(await page.locator('.start').isDisabled(), true);
  await server.say('counter placed 17');
  await page.waitForFunction(() => document.querySelector('[data-counter=placed]').textContent === '17');
  await server.say('log warning nobody is at home');
  await page.waitForFunction(() => document.querySelector('.log-list').textContent.includes('nobody is at home'));
  await page.locator('.reset').click();
  await page.waitForSelector('[data-mode=idle]');
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});

test('works under a host name on plain HTTP, in German, and asks nothing of other places', async () => {
  const page = await open(browser, server, { url: `http://cell.test:${server.port}/`, query: '?lang=de' });
  await showFrame(page, server);
  assert.equal(await page.evaluate(() => window.isSecureContext), false);
  assert.equal(await page.evaluate(() => document.documentElement.lang), 'de');
  assert.match(await page.textContent('.stop'), /Zyklus anhalten/);
  assert.deepEqual(page.troubles, []);
  await page.context().close();
});
