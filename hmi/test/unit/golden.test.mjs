// What the server's encoder wrote (tests/hmi/page_message_test.cpp) is what the page's parser reads.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { load, root } from '../load.mjs';

const { parseFrame, parseMessage } = await load('proto.ts');
const { applyMessage } = await load('model.ts');
const fixture = (name) => readFileSync(join(root, 'test/fixtures', name));
const bytes = (name) => new Uint8Array(fixture(name)).buffer;

test('the golden frame', () => {
  const frame = parseFrame(bytes('frame.bin'));
  assert.ok(frame);
  const { overlay, jpeg, ...header } = frame;
  assert.deepEqual(header, {
    kind: 1, camera: 2, frameId: 5, exposedMs: 1767225600123.456, w: 320, h: 256, scale: 0.5, simulated: true, overlayPending: true,
  });
  assert.deepEqual([...jpeg], [0xff, 0xd8, 1, 2, 0xff, 0xd9]);
  assert.deepEqual([overlay.f, overlay.sw, overlay.sh, overlay.recipe, overlay.ms.match], [5, 640, 512, 'brackets@3', 21.5]);
  assert.equal(overlay.dets.length, 7);
  assert.deepEqual(new Set(overlay.dets.map((d) => d.st)), new Set(['queued', 'found', 'picking', 'placed', 'missed', 'unknown', 'rejected']));
  const [part] = overlay.dets;
  assert.deepEqual([part.id, part.part, part.cx, part.cy, part.w, part.h, part.rx, part.ry], [50, 'bracket', 100 + (5 * 37) % 440, 120 + (5 * 53) % 330, 91, 45, 45, 22]);
  assert.equal(overlay.dets.find((d) => d.st === 'rejected').why, 'another part lies 3 mm beside the grasp');
});

test('the golden texts build the state they describe', () => {
  const messages = fixture('messages.jsonl').toString().trim().split('\n').map((line) => [line, parseMessage(line)]);
  for (const [line, message] of messages) {
    assert.ok(message, line);
    assert.deepEqual(message, JSON.parse(line));
  }
  const types = messages.map(([, m]) => m.type);
  assert.deepEqual(types, ['hello', 'snap', 'alarm', 'state', 'log', 'alarm', 'video', 'hb', 'snap']);
  let model = null;
  for (const [, message] of messages.slice(0, 5)) model = applyMessage(model, message);
  assert.equal(model.state.mode, 'fault');
  assert.equal(model.state.reason, 'link lost — "TCP 80"');
  assert.equal(model.state.cell, 'Cell 7', 'what did not change stays');
  assert.equal(model.counters.placed, 3);
  assert.deepEqual(model.alarms.map((a) => a.id), ['LINK_LOST']);
  assert.equal(model.log[0].text, 'no answer');
  model = applyMessage(model, messages[5][1]);
  assert.deepEqual(model.alarms, []);
  const afterDeltas = { ...model };
  assert.deepEqual(applyMessage(null, messages[8][1]), afterDeltas, 'changes and a fresh snap lead to the same');
});
