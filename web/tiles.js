// Tiles: their wire format, how a frame is cut into them, and in which steps samples are asked for.
import { decodeHalfs } from './half.js';

const HEADER_BYTES = 16;
const MAGIC = 'CT16';

/**
 * Reads a tile as the server sends it: "CT16", width, height and sample count as u32, then RGBA16F, little-endian,
 * linear, top row first.
 * @returns {{width: number, height: number, samples: number, rgba: Float32Array}} rgba: mean of the samples
 */
export function decodeTile(buffer) {
  if (buffer.byteLength < HEADER_BYTES) throw new Error(`the tile has only ${buffer.byteLength} bytes`);
  const view = new DataView(buffer);
  const magic = String.fromCharCode(...new Uint8Array(buffer, 0, 4));
  if (magic !== MAGIC) throw new Error('the tile does not start with CT16');
  const [width, height, samples] = [4, 8, 12].map((offset) => view.getUint32(offset, true));
  const expected = HEADER_BYTES + width * height * 8;
  if (buffer.byteLength !== expected) {
    throw new Error(`a tile of ${width}x${height} has ${expected} bytes, this one ${buffer.byteLength}`);
  }
  return { width, height, samples, rgba: decodeHalfs(buffer, HEADER_BYTES, width * height * 4) };
}

/**
 * Cuts a frame into tiles of at most `size` pixels a side, those nearest to the middle of the frame first.
 * @returns {{x: number, y: number, width: number, height: number}[]}
 */
export function tileGrid(frameWidth, frameHeight, size) {
  const tiles = [];
  for (let y = 0; y < frameHeight; y += size) {
    for (let x = 0; x < frameWidth; x += size) {
      tiles.push({ x, y, width: Math.min(size, frameWidth - x), height: Math.min(size, frameHeight - y) });
    }
  }
  const distance = (t) => Math.hypot(t.x + t.width / 2 - frameWidth / 2, t.y + t.height / 2 - frameHeight / 2);
  return tiles.sort((a, b) => distance(a) - distance(b));
}

/**
 * Sample ranges [first, end) from 0 to `total`: doubling up to `longest`, then steady. The steps do not depend on the
 * viewer, so that two viewers of one view ask for the same URLs and a cache can answer.
 */
export function sampleRanges(total, longest) {
  const ranges = [];
  let first = 0;
  while (first < total) {
    const length = Math.min(Math.max(first, 1), longest, total - first);
    ranges.push([first, first + length]);
    first += length;
  }
  return ranges;
}
