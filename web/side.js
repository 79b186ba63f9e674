// One picture in the making: a view, how far its tiles have come, and what they have brought.
import { tileUrl } from './api.js';
import { Film } from './film.js';
import { Progress } from './schedule.js';

export class Side {
  #film = null;

  /** `view`: {sceneId, camera, rounding, radius}; `frame`: {width, height}; `total`: samples of each pixel at the end. */
  constructor(view, frame, total) {
    this.view = view;
    this.frame = frame;
    this.key = Side.keyOf(view, frame);
    this.progress = new Progress(frame, total);
    this.abort = new AbortController();
    this.inFlight = 0;
    this.rays = 0;
    this.rounded = 0;
    /** Something of this view is to be seen, everywhere: a coarse picture at least. */
    this.isCovered = false;
  }

  /** Sides of one key have the same pixels. */
  static keyOf(view, frame) {
    return tileUrl(view, frame, { x: 0, y: 0, ...frame }, [0, 1]);
  }

  /** Made when it is first needed: while a view moves there are many that never are. */
  get film() {
    return (this.#film ??= new Film(this.frame.width, this.frame.height));
  }

  get hasTiles() {
    return this.#film !== null;
  }

  add({ tile, pass }, { rgba, samples, rays, rounded }) {
    this.film.add(tile, rgba, samples);
    this.progress.arrive(pass);
    this.rays += rays;
    this.rounded += rounded;
    if (this.progress.samples > 0) this.isCovered = true;
  }

  /** Samples that a tile has so far. */
  samplesOf({ x, y }) {
    return this.hasTiles ? this.film.counts[y * this.frame.width + x] : 0;
  }
}
