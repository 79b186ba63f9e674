import assert from 'node:assert/strict';
import { test } from 'node:test';

import { decodeHalfs, halfToNumber } from '../../../web/half.js';

test('halves of known value', () => {
  // IEEE 754-2008, binary16: sign, 5 bits of exponent (bias 15), 10 of fraction.
  const known = [
    [0x0000, 0],
    [0x3c00, 1],
    [0xc000, -2],
    [0x7bff, 65504],
    [0x0400, 2 ** -14],
    [0x0001, 2 ** -24],
    [0x3555, 0.333251953125],
    [0x7c00, Infinity],
    [0xfc00, -Infinity],
  ];
  for (const [bits, value] of known) assert.equal(halfToNumber(bits), value, `0x${bits.toString(16)}`);
  assert.ok(Number.isNaN(halfToNumber(0x7e00)));
  assert.ok(Object.is(halfToNumber(0x8000), -0));
});

test('values rise with their bits', () => {
  for (let bits = 1; bits <= 0x7c00; bits++) assert.ok(halfToNumber(bits) > halfToNumber(bits - 1));
});

test('a sequence is little-endian and starts at its offset', () => {
  const bytes = new Uint8Array([99, 0x00, 0x3c, 0x00, 0xc0]);
  assert.deepEqual([...decodeHalfs(bytes.buffer, 1, 2)], [1, -2]);
  assert.throws(() => decodeHalfs(bytes.buffer, 1, 3), RangeError);
});
