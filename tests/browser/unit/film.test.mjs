import assert from 'node:assert/strict';
import { test } from 'node:test';

import { displayByte, Film, srgbFromLinear } from '../../../web/film.js';

const tileOf = (pixels) => new Float32Array(pixels.flatMap(([r, g, b]) => [r, g, b, 1]));

test('means over adjacent sample ranges combine to the mean over their union', () => {
  const film = new Film(3, 2);
  const pixel = { x: 1, y: 1, width: 1, height: 1 };
  film.add(pixel, tileOf([[1, 0, 4]]), 1);
  film.add(pixel, tileOf([[0, 2, 4]]), 3);
  assert.deepEqual(film.mean(1, 1), [0.25, 1.5, 4]);
  assert.deepEqual(film.mean(0, 1), [0, 0, 0]);
});

test('a tile lands on its own pixels, top row first', () => {
  const film = new Film(4, 3);
  film.add({ x: 2, y: 1, width: 2, height: 2 }, tileOf([[1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]]), 5);
  const reds = [0, 1, 2].map((y) => [0, 1, 2, 3].map((x) => film.mean(x, y)[0]));
  assert.deepEqual(reds, [[0, 0, 0, 0], [0, 0, 1, 2], [0, 0, 3, 4]]);
});

test('the display transform is sRGB, clipped', () => {
  assert.equal(srgbFromLinear(0), 0);
  assert.ok(Math.abs(srgbFromLinear(1) - 1) < 1e-12);
  assert.ok(Math.abs(srgbFromLinear(0.214041140) - 0.5) < 1e-6); // mid grey of the display, linear
  // Both pieces of the curve meet.
  assert.ok(Math.abs(srgbFromLinear(0.0031308) - srgbFromLinear(0.0031309)) < 1e-5);
  for (let byte = 0; byte < 256; byte++) {
    const display = byte / 255;
    const linear = display <= 0.04045 ? display / 12.92 : ((display + 0.055) / 1.055) ** 2.4;
    assert.ok(Math.abs(displayByte(linear) - byte) <= 1, `${byte} comes back as ${displayByte(linear)}`);
  }
  assert.deepEqual([displayByte(7), displayByte(Infinity), displayByte(-1), displayByte(NaN)], [255, 255, 0, 0]);
});

test('a rectangle is written opaque and in its own size', () => {
  const film = new Film(2, 2);
  film.add({ x: 0, y: 0, width: 2, height: 2 }, tileOf([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), 2);
  const bytes = new Uint8ClampedArray(8);
  film.display({ x: 0, y: 1, width: 2, height: 1 }, bytes);
  assert.deepEqual([...bytes], [0, 255, 0, 255, 0, 0, 255, 255]);
});
