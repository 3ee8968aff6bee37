// The parsers take anything and throw at nothing.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { load, random, root } from '../load.mjs';

const { parseFrame, parseMessage } = await load('proto.ts');
const golden = new Uint8Array(readFileSync(join(root, 'test/fixtures/frame.bin')));
const lines = readFileSync(join(root, 'test/fixtures/messages.jsonl'), 'utf8').trim().split('\n');
const copy = (from, length = from.length) => from.slice(0, length);
const jsonLength = new DataView(golden.buffer).getUint32(12, true);

test('100000 random buffers', () => {
  const rnd = random(1);
  for (let i = 0; i < 100000; ++i) {
    const data = Uint8Array.from({ length: Math.floor(rnd() * 64) }, () => Math.floor(rnd() * 256));
    if (i % 2) data.set(copy(golden, Math.min(8, data.length)));
    assert.equal(parseFrame(data.buffer), null);
  }
});

test('every truncation before the picture is refused', () => {
  for (let n = 0; n <= 32 + jsonLength; ++n) assert.equal(parseFrame(copy(golden, n).buffer), null, `${n} bytes`);
});

test('every flipped byte of header and overlay is refused or changes only its own value', () => {
  const rnd = random(2);
  for (let i = 0; i < 20000; ++i) {
    const data = copy(golden);
    data[Math.floor(rnd() * (32 + jsonLength))] ^= 1 << Math.floor(rnd() * 8);
    const frame = parseFrame(data.buffer);
    if (!frame) continue;
    assert.equal(frame.overlay.f, frame.frameId, 'a frame never carries the overlay of another');
    for (const d of frame.overlay.dets) assert.ok([d.cx, d.cy, d.deg, d.sc, d.score].every(Number.isFinite));
  }
});

test('wrong magic, version, kind, sizes and lengths', () => {
  const broken = (edit) => {
    const data = copy(golden);
    edit(new DataView(data.buffer));
    return parseFrame(data.buffer);
  };
  assert.ok(broken(() => {}));
  assert.equal(broken((v) => v.setUint32(0, 1)), null);
  assert.equal(broken((v) => v.setUint8(4, 2)), null);
  assert.equal(broken((v) => v.setUint8(5, 0)), null);
  assert.equal(broken((v) => v.setUint8(5, 9)), null);
  assert.equal(broken((v) => v.setUint16(24, 0, true)), null);
  assert.equal(broken((v) => v.setUint16(24, 16385, true)), null);
  assert.equal(broken((v) => v.setUint16(26, 16385, true)), null);
  assert.equal(broken((v) => v.setUint16(28, 0, true)), null);
  assert.equal(broken((v) => v.setUint32(12, 0xffffffff, true)), null);
  assert.equal(broken((v) => v.setUint32(12, (1 << 20) + 1, true)), null);
  assert.equal(broken((v) => v.setUint32(8, 6, true)), null, 'the overlay names another frame');
});

test('texts: cut, altered and foreign ones', () => {
  const rnd = random(3);
  for (const text of ['', 'null', '[]', '1', '{}', '{"type":"toString"}', '{"type":"snap"}', '{"type":1}']) assert.equal(parseMessage(text), null, text);
  for (const line of lines) for (let n = 0; n < line.length; n += 3) assert.equal(parseMessage(line.slice(0, n)), null);
  for (let i = 0; i < 20000; ++i) {
    const line = lines[Math.floor(rnd() * lines.length)];
    const at = Math.floor(rnd() * line.length);
    parseMessage(line.slice(0, at) + String.fromCharCode(32 + Math.floor(rnd() * 95)) + line.slice(at + 1));
  }
});
