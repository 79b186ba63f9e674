// Keeps the canvases in step with a view, or with two that are compared. While a view moves: coarse whole-frame pictures, one
// after the other, the newest view next. Once it rests: tiles of ever more samples, a few requests at a time, gathered in the
// film of each side. Whatever a newer view outdates is aborted, so the server can stop working on it; a side that stays keeps
// its tiles.
import { fetchTile, ServerError, tileUrl } from './api.js';
import { filmOf, Painter } from './painter.js';
import { Retry } from './retry.js';
import { nextOf } from './schedule.js';
import { Side } from './side.js';
import { retryText } from './words.js';

const REQUESTS_IN_FLIGHT = 3; // of both sides together
const SETTLE_MS = 180;
/** Coarse pictures are made as fine as fits this time. */
const PREVIEW_MS = 90;
const COARSEST = 12;
const FINEST = 2;
const NOTHING = '#101112';

/**
 * @typedef {{sceneId: string, camera: object, rounding: string, radius: ?number}} View
 * @typedef {{phase: 'idle'|'moving'|'rendering'|'done'|'waiting'|'failed', samples: number, total: number,
 *            seconds: number, rays: number, rounded: number, message: string}} Status
 */
export class Renderer {
  /**
   * `canvases`: of the picture, and of the one that it is compared with, of the same size always. `heatMap`: a HeatMap of
   * that size. `onStatus` gets a Status whenever something changes. `total`: samples per pixel of the finished picture.
   */
  constructor(canvases, heatMap, { total, onStatus }) {
    this.painters = canvases.map((canvas) => new Painter(canvas));
    this.heatMap = heatMap;
    this.total = total;
    this.onStatus = onStatus;
    /** By canvas; equal views are one and the same Side. */
    this.sides = [];
    this.showsDifference = false;
    this.previewScale = 4;
    this.preview = null; // AbortController of the coarse pictures that are on their way
    this.rested = true;
    this.settleTimer = 0;
    this.isPaused = false;
    this.status = { phase: 'idle', samples: 0, total, seconds: 0, rays: 0, rounded: 0, message: '' };
  }

  /**
   * Shows one view, or two beside each other, at once in full quality or, when `moving`, coarsely until they have rested for
   * a moment; the map of their difference, too, where `difference`.
   */
  show(views, { moving = false, difference = false } = {}) {
    clearTimeout(this.settleTimer);
    this.rested = !moving;
    this.#take(views);
    if (difference && !moving && !(this.showsDifference && this.sides.every((side) => side.isCovered))) this.heatMap.forget();
    else this.heatMap.hide();
    this.showsDifference = difference;
    if (moving) {
      this.settleTimer = setTimeout(() => {
        this.rested = true;
        if (!this.preview) this.#refine();
      }, SETTLE_MS);
      if (!this.preview) this.#preview();
    } else {
      this.preview?.abort();
      this.preview = null;
      // Of two pictures none may be taken for that of another setting: what is left of an older one goes at once.
      if (views.length > 1 && this.sides.some((side) => !side.isCovered)) this.#preview();
      else this.#refine();
    }
  }

  /** Sets the pictures' size in pixels. True when it has changed: the views must be shown again then. */
  resize(width, height) {
    this.heatMap.resize(width, height);
    return this.painters.map((painter) => painter.resize(width, height)).includes(true);
  }

  /** Asks for no further tiles until resume(); what has gathered stays. */
  pause() {
    this.isPaused = true;
  }

  resume() {
    this.isPaused = false;
    if (this.rested && !this.preview && this.sides.length > 0) this.#pump();
  }

  /** Makes `this.sides` those of the views, keeps what is known of them, and drops the others. */
  #take(views) {
    const before = this.sides;
    const { width, height } = this.painters[0].canvas;
    const frame = { width, height };
    const known = [...before];
    this.sides = views.map((view) => {
      const key = Side.keyOf(view, frame);
      const kept = known.find((side) => side.key === key);
      if (kept) return kept;
      known.push(new Side(view, frame, this.total));
      return known.at(-1);
    });
    for (const side of before) if (!this.sides.includes(side)) side.abort.abort();
    for (const [i, side] of this.sides.entries()) {
      if (before[i] === side) continue;
      if (side.hasTiles && side.isCovered && side.progress.samples > 0) this.painters[i].all(side.film);
      else if (!before[i] && i > 0) this.painters[i].clear(NOTHING);
      if (before.includes(side) && side.progress.samples === 0) side.isCovered = false; // on another canvas
    }
  }

  #report(change) {
    this.status = { ...this.status, ...change };
    this.onStatus(this.status);
  }

  /** Coarse pictures of those sides that have none, until all have one. */
  async #preview() {
    const { signal } = (this.preview = new AbortController());
    this.#report({ phase: 'moving', samples: 0, message: '' });
    try {
      while (this.sides.some((side) => !side.isCovered)) await this.#coarsePictures(signal);
    } catch (error) {
      // The full picture follows anyway, and says what is wrong if it still is.
      if (error.name !== 'AbortError' && !(error instanceof ServerError)) throw error;
    }
    if (signal.aborted) return;
    this.preview = null;
    if (this.rested) this.#refine();
  }

  async #coarsePictures(signal) {
    const sides = this.sides;
    const { width, height } = this.painters[0].canvas;
    const frame = { width: Math.ceil(width / this.previewScale), height: Math.ceil(height / this.previewScale) };
    const wanted = [...new Set(sides)].filter((side) => !side.isCovered || this.showsDifference);
    const started = performance.now();
    const tiles = await Promise.all(
      wanted.map((side) => fetchTile(tileUrl(side.view, frame, { x: 0, y: 0, ...frame }, [0, 1]), signal)),
    );
    if (signal.aborted) return;
    this.#adaptPreview(performance.now() - started);
    const films = new Map(wanted.map((side, i) => [side, filmOf(tiles[i])]));
    for (const [i, side] of sides.entries()) {
      if (!films.has(side) || side.isCovered) continue;
      this.painters[i].enlarged(films.get(side));
    }
    for (const side of wanted) side.isCovered = true;
    if (this.showsDifference) this.heatMap.showCoarse(...sides.map((side) => films.get(side)));
    const sum = (name) => tiles.reduce((all, tile) => all + tile[name], 0);
    this.#report({ rays: sum('rays'), rounded: sum('rounded') });
  }

  #adaptPreview(milliseconds) {
    if (milliseconds > PREVIEW_MS * 1.4) this.previewScale = Math.min(COARSEST, this.previewScale * 1.25);
    if (milliseconds < PREVIEW_MS * 0.6) this.previewScale = Math.max(FINEST, this.previewScale / 1.15);
  }

  /** Renders the present views until they have all their samples or others take their place. */
  #refine() {
    this.started = performance.now();
    if (this.showsDifference) this.heatMap.show(this.sides);
    this.retry = new Retry((seconds, error) => this.#reportProgress('waiting', retryText(error, seconds)));
    this.#reportProgress('rendering');
    this.#pump();
  }

  #reportProgress(phase, message = '') {
    const sides = [...new Set(this.sides)];
    const sum = (name) => sides.reduce((all, side) => all + side[name], 0);
    const samples = Math.min(...sides.map((side) => side.progress.samples));
    const seconds = (performance.now() - this.started) / 1000;
    this.#report({ phase, message, samples, rays: sum('rays'), rounded: sum('rounded'), seconds });
  }

  #pump() {
    if (!this.rested || this.preview) return;
    const sides = [...new Set(this.sides)];
    const inFlight = () => sides.reduce((all, side) => all + side.inFlight, 0);
    while (!this.isPaused && inFlight() < REQUESTS_IN_FLIGHT) {
      const progress = nextOf(sides.map((side) => side.progress));
      if (!progress) break;
      this.#render(sides.find((side) => side.progress === progress), progress.take());
    }
    if (sides.length > 0 && inFlight() === 0 && sides.every((side) => side.progress.isAllAsked)) this.#reportProgress('done');
  }

  async #render(side, place) {
    const { signal } = side.abort;
    side.inFlight++;
    try {
      const url = tileUrl(side.view, side.frame, place.tile, place.range);
      const result = await this.retry.run(() => fetchTile(url, signal), signal);
      if (signal.aborted) return;
      side.add(place, result);
      for (const [i, shown] of this.sides.entries()) if (shown === side) this.painters[i].tile(side.film, place.tile);
      if (this.showsDifference) this.heatMap.take(side, place.tile);
    } catch (error) {
      if (signal.aborted || error.name === 'AbortError') return;
      this.#fail(error);
      return;
    } finally {
      side.inFlight--;
    }
    if (!this.rested || this.preview) return;
    this.#reportProgress('rendering');
    this.#pump();
  }

  /** Gives up; whatever is shown next begins anew. */
  #fail(error) {
    for (const side of this.sides) side.abort.abort();
    this.sides = [];
    if (!(error instanceof ServerError)) throw error;
    this.#report({ phase: 'failed', message: error.message });
  }
}
