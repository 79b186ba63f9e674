// The canvas that shows where two sides differ, and the scale beside it.
import { Difference, UNKNOWN } from './difference.js';
import { Painter } from './painter.js';

const wholeOf = ({ width, height }) => ({ x: 0, y: 0, width, height });

export class HeatMap {
  /** `onScale(top, isKnown)` is told of the largest difference on the scale, and whether anything is known at all. */
  constructor(canvas, onScale) {
    this.painter = new Painter(canvas);
    this.onScale = onScale;
    this.sides = [];
    this.difference = null;
  }

  resize(width, height) {
    return this.painter.resize(width, height);
  }

  /** Shows the difference of these two from now on, as far as it is known; nothing of it: what is there stays until it is. */
  show(sides) {
    if (this.sides[0] === sides[0] && this.sides[1] === sides[1]) return;
    this.sides = sides;
    this.difference = new Difference(sides[0].frame.width, sides[0].frame.height);
    if (!sides.every((side) => side.hasTiles)) return;
    for (const tile of sides[0].progress.tiles) this.difference.update(tile, sides[0].film, sides[1].film);
    this.painter.all(this.difference);
    this.onScale(this.difference.top, true);
  }

  /** What is there is of something else. */
  forget() {
    this.hide();
    this.painter.clear(`rgb(${UNKNOWN})`);
    this.onScale(0, false);
  }

  /** Takes no tiles until show(). */
  hide() {
    this.sides = [];
    this.difference = null;
  }

  /** Films of whole, coarse pictures of the two. */
  showCoarse(a, b) {
    const difference = new Difference(a.width, a.height);
    difference.update(wholeOf(a), a, b);
    this.painter.enlarged(difference);
    this.onScale(difference.top, true);
  }

  /**
   * `side` has got a tile. Where the other has fewer samples yet its tile is on its way, and with equal samples the noise that
   * both have in common goes.
   */
  take(side, tile) {
    const [a, b] = this.sides;
    const other = side === a ? b : a;
    if (!this.difference || ![a, b].includes(side) || side.samplesOf(tile) > other.samplesOf(tile)) return;
    if (this.difference.update(tile, a.film, b.film)) this.painter.all(this.difference);
    else this.painter.tile(this.difference, tile);
    this.onScale(this.difference.top, true);
  }
}
