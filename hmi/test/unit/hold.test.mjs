import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FakeTime, load } from '../load.mjs';

const { Hold, kHoldMs } = await load('hold.ts');

function begin() {
  const time = new FakeTime();
  let acted = 0;
  const hold = new Hold(() => ++acted, time.later, () => {});
  return { time, hold, acted: () => acted };
}

test('acts once after 0.8 s, not before', () => {
  const { time, hold, acted } = begin();
  hold.press();
  time.advance(kHoldMs - 1);
  assert.equal(acted(), 0);
  time.advance(1);
  assert.equal(acted(), 1);
  time.advance(5000);
  assert.equal(acted(), 1);
});

test('letting go calls it off, also when pressed again at once', () => {
  const { time, hold, acted } = begin();
  for (let i = 0; i < 10; ++i) {
    hold.press();
    time.advance(kHoldMs - 10);
    hold.release();
    time.advance(5);
  }
  time.advance(kHoldMs);
  assert.equal(acted(), 0, 'ten short presses are not a long one');
});
