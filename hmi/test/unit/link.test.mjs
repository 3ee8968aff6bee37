// The dead-page rule on a clock of the test's own.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FakeTime, load } from '../load.mjs';

const { Link, kSilenceMs } = await load('link.ts');

function begin() {
  const time = new FakeTime();
  const sockets = [];
  const seen = { opened: 0, silent: [], texts: [] };
  const link = new Link(
    {
      connect: () => {
        const s = { sent: [], closed: false, at: time.now, send: (t) => s.sent.push(t), close: () => (s.closed = true) };
        sockets.push(s);
        return s;
      },
      now: () => time.now,
      later: time.later,
    },
    { opened: () => ++seen.opened, text: (t) => seen.texts.push(t), binary: () => {}, silent: () => seen.silent.push(time.now) },
  );
  return { time, sockets, seen, link };
}

function beat({ time, sockets }, seconds) {
  for (let i = 0; i < seconds; ++i) {
    time.advance(1000);
    sockets.at(-1).onmessage({ data: '{"type":"hb","t":1}' });
  }
}

/** Milliseconds until the next attempt. */
function untilNext({ time, sockets }) {
  const before = time.now;
  const count = sockets.length;
  while (sockets.length === count) time.advance(50);
  return time.now - before;
}

test('a frozen server that keeps its socket open is noticed within 4 s', () => {
  const page = begin();
  page.sockets[0].onopen();
  beat(page, 20);
  assert.deepEqual(page.seen.silent, []);
  page.time.advance(4000);
  assert.equal(page.seen.silent.length, 1);
  const noticed = page.seen.silent[0] - 20000;
  assert.ok(noticed > kSilenceMs && noticed <= 4000, `${noticed} ms`);
  assert.ok(page.sockets[0].closed, 'the frozen connection is given up');
});

test('tries again after 0.5, 1, 2, 4, 4 s and begins anew when heard', () => {
  const page = begin();
  page.sockets[0].onopen();
  const waits = [];
  for (let i = 0; i < 5; ++i) {
    page.sockets.at(-1).onclose();
    waits.push(untilNext(page));
  }
  assert.deepEqual(waits, [500, 1000, 2000, 4000, 4000]);
  page.sockets.at(-1).onopen();
  page.sockets.at(-1).onmessage({ data: 'x' });
  page.sockets.at(-1).onclose();
  assert.equal(untilNext(page), 500);
});

test('a server that accepts and says nothing is not waited for for ever', () => {
  const page = begin();
  page.time.advance(60000);
  assert.ok(page.sockets.length >= 6, `${page.sockets.length} attempts in a minute`);
  assert.equal(page.seen.silent.length, 1, 'said once');
  untilNext(page);
  page.sockets.at(-1).onopen();
  page.sockets.at(-1).onmessage({ data: 'hello' });
  assert.deepEqual(page.seen.texts, ['hello']);
});

test('a short break between two beats is not a dead page', () => {
  const page = begin();
  page.sockets[0].onopen();
  beat(page, 3);
  page.sockets[0].onclose();
  page.time.advance(500);
  page.sockets[1].onopen();
  page.sockets[1].onmessage({ data: 'hello' });
  beat(page, 5);
  assert.deepEqual(page.seen.silent, []);
  assert.equal(page.seen.opened, 2);
});

test('a late event of a given-up connection changes nothing', () => {
  const page = begin();
  page.sockets[0].onopen();
  page.time.advance(5000);
  assert.equal(page.sockets[0].onmessage, null);
  assert.equal(page.sockets[0].onclose, null);
});
