import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { load, root } from '../load.mjs';

const { applyMessage } = await load('model.ts');
const snap = () => JSON.parse(readFileSync(join(root, 'test/fixtures/messages.jsonl'), 'utf8').split('\n')[1]);
const begin = () => applyMessage(null, snap());
const alarm = (id, priority, last_us = 1, active = true) => ({ id, code: id, priority, text: id, cause: '', remedies: [], first_us: 1, last_us, count: 1, active });

test('a change on another base asks for everything', () => {
  const model = begin();
  const { state } = model.rev;
  assert.equal(applyMessage(model, { type: 'state', rev: state + 2, base: state + 1, step: 'x' }), 'resync');
  assert.equal(applyMessage(model, { type: 'state', rev: state + 5, base: state, step: 'x' }).state.step, 'x', 'gathered changes are no gap');
});

test('a missed alarm asks for everything', () => {
  const model = begin();
  assert.equal(applyMessage(model, { type: 'alarm', rev: model.rev.alarm + 2, row: alarm('a', 1) }), 'resync');
});

test('alarms: active first, then urgent, then new; the same one once', () => {
  let model = begin();
  const add = (row) => (model = applyMessage(model, { type: 'alarm', rev: model.rev.alarm + 1, row }));
  add(alarm('low', 3, 9));
  add(alarm('old', 2, 1));
  add(alarm('new', 2, 5));
  add(alarm('gone by', 1, 9, false));
  add(alarm('high', 1, 1));
  add({ ...alarm('low', 3, 9), count: 2 });
  assert.deepEqual(model.alarms.map((a) => a.id), ['high', 'new', 'old', 'low', 'gone by']);
  assert.equal(model.alarms[3].count, 2);
  add({ id: 'high', gone: true });
  assert.deepEqual(model.alarms.map((a) => a.id), ['new', 'old', 'low', 'gone by']);
});

test('the log keeps 200 lines and takes none twice', () => {
  let model = begin();
  const row = (n) => ({ n, us: 1, level: 'info', module: 'm', text: String(n) });
  for (let n = 1; n <= 500; n += 10) model = applyMessage(model, { type: 'log', rows: Array.from({ length: 20 }, (_, i) => row(n + i)) });
  assert.equal(model.log.length, 200);
  assert.deepEqual(model.log.map((r) => r.n), Array.from({ length: 200 }, (_, i) => 311 + i));
});

test('before the first snap nothing is believed', () => {
  assert.equal(applyMessage(null, { type: 'state', rev: 1, base: 0, step: 'x' }), null);
});
