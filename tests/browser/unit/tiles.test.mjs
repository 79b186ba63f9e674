import assert from 'node:assert/strict';
import { test } from 'node:test';

import { decodeTile, sampleRanges, tileGrid } from '../../../web/tiles.js';

function tileBytes({ magic = 'CT16', width = 2, height = 1, samples = 3, halfs = [0, 0x3c00, 0, 0, 0, 0, 0xc000, 0] }) {
  const buffer = new ArrayBuffer(16 + halfs.length * 2);
  const view = new DataView(buffer);
  [...magic].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  [width, height, samples].forEach((value, i) => view.setUint32(4 + 4 * i, value, true));
  halfs.forEach((bits, i) => view.setUint16(16 + 2 * i, bits, true));
  return buffer;
}

test('a tile is read as it was written', () => {
  const tile = decodeTile(tileBytes({}));
  assert.deepEqual([tile.width, tile.height, tile.samples], [2, 1, 3]);
  assert.deepEqual([...tile.rgba], [0, 1, 0, 0, 0, 0, -2, 0]);
});

test('a tile that is cut short, too long or no tile is refused with the reason', () => {
  assert.throws(() => decodeTile(new ArrayBuffer(7)), /only 7 bytes/);
  assert.throws(() => decodeTile(tileBytes({ magic: 'PNG!' })), /CT16/);
  assert.throws(() => decodeTile(tileBytes({ height: 2 })), /2x2 has 48 bytes, this one 32/);
  assert.throws(() => decodeTile(tileBytes({ width: 1 })), /1x1 has 24 bytes/);
});

test('tiles cover a frame exactly once, the middle first', () => {
  const [width, height, size] = [700, 530, 256];
  const covered = new Uint8Array(width * height);
  const tiles = tileGrid(width, height, size);
  for (const tile of tiles) {
    assert.ok(tile.width <= size && tile.height <= size);
    for (let y = tile.y; y < tile.y + tile.height; y++)
      for (let x = tile.x; x < tile.x + tile.width; x++) covered[y * width + x]++;
  }
  assert.ok(covered.every((times) => times === 1));
  const [first] = tiles;
  assert.ok(first.x <= width / 2 && first.x + first.width >= width / 2);
  assert.ok(first.y <= height / 2 && first.y + first.height >= height / 2);
});

test('sample ranges join without gaps, double, and stay below their longest', () => {
  assert.deepEqual(sampleRanges(16, 64), [[0, 1], [1, 2], [2, 4], [4, 8], [8, 16]]);
  for (const [total, longest] of [[256, 16], [1, 16], [37, 8], [100, 1]]) {
    const ranges = sampleRanges(total, longest);
    assert.equal(ranges[0][0], 0);
    assert.equal(ranges.at(-1)[1], total);
    ranges.forEach(([first, end], i) => {
      assert.ok(end > first && end - first <= longest);
      if (i > 0) assert.equal(first, ranges[i - 1][1]);
    });
  }
});
