import assert from 'node:assert/strict';
import { test } from 'node:test';

import { splitAfter } from '../../../web/divider.js';

test('keys move the divider, within the picture', () => {
  const moves = [
    ['ArrowLeft', false, 49], ['ArrowDown', false, 49], ['ArrowRight', false, 51], ['ArrowUp', false, 51],
    ['ArrowRight', true, 60], ['PageUp', false, 60], ['PageDown', false, 40], ['Home', false, 0], ['End', false, 100],
  ];
  for (const [key, isShifted, split] of moves) assert.equal(splitAfter(key, 50, isShifted), split, key);
  assert.equal(splitAfter('ArrowLeft', 0.5, false), 0);
  assert.equal(splitAfter('PageUp', 95, false), 100);
  for (const key of ['Tab', 'a', 'Enter', '+']) assert.equal(splitAfter(key, 50, false), null, key);
});
