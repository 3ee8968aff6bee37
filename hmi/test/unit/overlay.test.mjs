// The overlay's geometry against the convention of docs/interfaces: scene = c + s*R(a)*(t - ref), R = [[cos, sin], [-sin, cos]].
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load, random } from '../load.mjs';

const { corners, distance, partAt } = await load('view/overlay.ts');
const det = (more) => ({ id: 1, part: 'p', cx: 100, cy: 50, deg: 0, sc: 1, w: 40, h: 20, rx: 19.5, ry: 9.5, score: 1, st: 'found', why: null, grip: [], ...more });
const near = (a, b) => assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-9, `${a} is not ${b}`);

test('unturned, the outline runs along pixel edges', () => {
  const [a, b, c, d] = corners(det());
  near(a, [80, 40]);
  near(b, [120, 40]);
  near(c, [120, 60]);
  near(d, [80, 60]);
});

test('90 degrees counter-clockwise on the screen: the right edge goes up', () => {
  const [, topRight] = corners(det({ deg: 90 }));
  near(topRight, [90, 30]);
});

test('the reference point stays where it is, whatever turns and grows about it', () => {
  const rnd = random(4);
  for (let i = 0; i < 200; ++i) {
    const d = det({ deg: rnd() * 360 - 180, sc: 0.5 + rnd(), rx: rnd() * 39, ry: rnd() * 19 });
    assert.equal(distance(d, [d.cx, d.cy]), 0);
    for (const corner of corners(d)) assert.ok(distance(d, corner) < 1e-9);
    const [a, b] = corners(d);
    assert.ok(Math.abs(Math.hypot(a[0] - b[0], a[1] - b[1]) - 40 * d.sc) < 1e-9);
  }
});

test('a finger takes the nearest part in reach, and none beyond', () => {
  const overlay = { dets: [det({ id: 1 }), det({ id: 2, cx: 150 })] };
  assert.equal(partAt(overlay, [126, 50], 24).id, 2);
  assert.equal(partAt(overlay, [100, 50], 24).id, 1);
  assert.equal(partAt(overlay, [100, 300], 24), null);
});
