// In which order the tiles of one picture, or of two that are compared, are asked for.
import { sampleRanges, tileGrid } from './tiles.js';

const TILE_SIZE = 256;
const LONGEST_RANGE = 16;

/** How far one picture has come: pass by pass, in each its tiles from the middle outwards. */
export class Progress {
  constructor({ width, height }, total) {
    this.tiles = tileGrid(width, height, TILE_SIZE);
    this.ranges = sampleRanges(total, LONGEST_RANGE);
    this.asked = 0; // tiles, over all passes
    this.arrived = new Array(this.ranges.length).fill(0);
    this.samples = 0; // that every pixel has
  }

  get isAllAsked() {
    return this.asked === this.tiles.length * this.ranges.length;
  }

  /** The next to be asked for: {tile, range, pass}. */
  take() {
    const pass = Math.floor(this.asked / this.tiles.length);
    const tile = this.tiles[this.asked++ % this.tiles.length];
    return { tile, range: this.ranges[pass], pass };
  }

  arrive(pass) {
    if (++this.arrived[pass] === this.tiles.length) this.samples = Math.max(this.samples, this.ranges[pass][1]);
  }
}

/**
 * Which of these goes on next, null when all have been asked for: the one that is behind, so that a place of one picture is
 * followed by the same place of the other, and one that begins anew catches up.
 */
export function nextOf(all) {
  const waiting = all.filter((progress) => !progress.isAllAsked);
  return waiting.reduce((least, one) => (least && least.asked <= one.asked ? least : one), null);
}
