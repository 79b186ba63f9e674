import assert from 'node:assert/strict';
import { test } from 'node:test';

import { Difference, roundedUp, ticks, UNKNOWN } from '../../../web/difference.js';
import { Film } from '../../../web/film.js';

const whole = { x: 0, y: 0, width: 2, height: 1 };

function film(pixels, samples = 1, tile = whole) {
  const made = new Film(2, 1);
  made.add(tile, new Float32Array(pixels.flatMap((rgb) => [...rgb, 1])), samples);
  return made;
}

function colors(difference) {
  const bytes = new Uint8ClampedArray(8);
  difference.display(whole, bytes);
  return [[...bytes.slice(0, 3)], [...bytes.slice(4, 7)]];
}

test('the largest difference of the channels is shown, whichever side is brighter', () => {
  const difference = new Difference(2, 1);
  const a = film([[0.5, 0.5, 0.5], [0.1, 0.1, 0.1]], 4);
  const b = film([[0.5, 0.4, 1], [0.1, 0.1, 0.1]], 4);
  assert.equal(difference.update(whole, a, b), true);
  assert.deepEqual([...difference.values], [0.5, 0]);
  assert.equal(difference.top, 0.5);
  // The report's colours: server/jobs/report/color_map.cpp.
  assert.deepEqual(colors(difference), [[0xfc, 0xfd, 0xbf], [0x00, 0x00, 0x04]]);
  const mirrored = new Difference(2, 1);
  mirrored.update(whole, b, a);
  assert.deepEqual([...mirrored.values], [0.5, 0]);
});

test('the scale is logarithmic, three decades long', () => {
  const difference = new Difference(2, 1);
  difference.update(whole, film([[1, 0, 0], [10 ** -1.5, 0, 0]]), film([[0, 0, 0], [0, 0, 0]]));
  const [, middle] = colors(difference);
  assert.deepEqual(middle, [0xb6, 0x36, 0x79]); // half of the way
  assert.deepEqual(ticks(1), ['≤ 0.001', '0.01', '0.1', '1']);
  assert.deepEqual(ticks(0), []);
});

test('what one side has not yet is neither same nor different', () => {
  const difference = new Difference(2, 1);
  const half = film([[1, 1, 1]], 1, { x: 0, y: 0, width: 1, height: 1 });
  difference.update(whole, half, film([[0, 0, 0], [0, 0, 0]]));
  assert.deepEqual(colors(difference)[1], UNKNOWN);
  assert.deepEqual(colors(difference)[0], [0xfc, 0xfd, 0xbf]);
});

test('the top of the scale goes in steps, and down again when a difference was noise', () => {
  const steps = [[0.3, 0.5], [0.5, 0.5], [0.51, 1], [1.1, 2], [0.07, 0.1], [3e-5, 5e-5], [0, 0], [NaN, 0]];
  for (const [value, top] of steps) assert.equal(roundedUp(value), top, `${value}`);
  const difference = new Difference(2, 1);
  const black = film([[0, 0, 0], [0, 0, 0]]);
  assert.equal(difference.update(whole, film([[9, 0, 0], [0, 0, 0]]), black), true);
  assert.equal(difference.update(whole, film([[8, 0, 0], [0, 0, 0]]), black), false);
  assert.equal(difference.update(whole, film([[0.2, 0, 0], [0, 0, 0]]), black), true);
  assert.equal(difference.top, 0.2);
});
