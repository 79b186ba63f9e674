import assert from 'node:assert/strict';
import { test } from 'node:test';

import { nextOf, Progress } from '../../../web/schedule.js';

const FRAME = { width: 700, height: 500 }; // 3 x 2 tiles

const order = (sides, count) =>
  Array.from({ length: count }, () => {
    const next = nextOf(sides);
    return [sides.indexOf(next), next.take()];
  });

test('two pictures take turns place by place, the middle first, with the same samples', () => {
  const sides = [new Progress(FRAME, 8), new Progress(FRAME, 8)];
  const taken = order(sides, 2 * 6 * 4);
  for (let i = 0; i < taken.length; i += 2) {
    assert.deepEqual([taken[i][0], taken[i + 1][0]], [0, 1]);
    assert.deepEqual(taken[i][1], taken[i + 1][1]);
  }
  const [, { tile, range }] = taken[0];
  assert.deepEqual(range, [0, 1]);
  assert.ok(tile.x < 350 && tile.x + tile.width > 350);
  assert.equal(nextOf(sides), null);
});

test('one that begins anew catches up, and what the other has is not asked for again', () => {
  const old = new Progress(FRAME, 256);
  order([old], 6 * 3 + 2);
  const fresh = new Progress(FRAME, 256);
  assert.ok(order([old, fresh], 6 * 3 + 2).every(([side]) => side === 1));
  assert.deepEqual(order([old, fresh], 4).map(([side]) => side), [0, 1, 0, 1]);
});

test('samples count when every tile of a pass has arrived', () => {
  const side = new Progress(FRAME, 4);
  for (const { pass } of Array.from({ length: 11 }, () => side.take())) side.arrive(pass);
  assert.equal(side.samples, 1);
  side.arrive(side.take().pass);
  assert.equal(side.samples, 2);
});
