// How often a command is sent that gets no answer: a late Start is dangerous, a late Stop is not.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { load } from '../load.mjs';

const { command } = await load('api.ts');

for (const [name, times] of [['start', 1], ['reset', 1], ['stop', 3]]) {
  test(`${name} without an answer is sent ${times} time(s), always with the same key`, async (t) => {
    const keys = [];
    t.mock.method(globalThis, 'fetch', async (url, options) => {
      assert.equal(url, `/api/v1/${name}`);
      keys.push(options.headers['Idempotency-Key']);
      throw new TypeError('no network');
    });
    assert.deepEqual(await command(name, 'no answer'), { text: 'no answer', remedies: [] });
    assert.equal(keys.length, times);
    assert.equal(new Set(keys).size, 1);
  });
}
