// Keeps the canvas in step with a view. While the view moves: coarse whole-frame pictures, one request at a time, the
// newest view next. Once it rests: tiles of ever more samples, a few requests at a time, gathered in a Film. Whatever
// a newer view outdates is aborted, so the server can stop working on it.
import { fetchTile, ServerError, tileUrl } from './api.js';
import { Film } from './film.js';
import { Retry } from './retry.js';
import { sampleRanges, tileGrid } from './tiles.js';
import { retryText } from './words.js';

const TILE_SIZE = 256;
const REQUESTS_IN_FLIGHT = 3;
const LONGEST_RANGE = 16;
const SETTLE_MS = 180;
/** Coarse pictures are made as fine as fits this time. */
const PREVIEW_MS = 90;
const COARSEST = 12;
const FINEST = 2;

/**
 * @typedef {{sceneId: string, camera: object, rounding: string, radius: ?number}} View
 * @typedef {{phase: 'idle'|'moving'|'rendering'|'done'|'waiting'|'failed', samples: number, total: number,
 *            seconds: number, rays: number, rounded: number, message: string}} Status
 */
export class Renderer {
  /** `onStatus` gets a Status whenever something changes. `total`: samples per pixel of the finished picture. */
  constructor(canvas, { total, onStatus }) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false });
    this.total = total;
    this.onStatus = onStatus;
    this.view = null;
    this.previewScale = 4;
    this.abort = new AbortController();
    this.previewing = false;
    this.rested = true;
    this.settleTimer = 0;
    this.gate = null;
    this.coarse = document.createElement('canvas');
    this.status = { phase: 'idle', samples: 0, total, seconds: 0, rays: 0, rounded: 0, message: '' };
  }

  /** Shows `view`, at once in full quality or, when `moving`, coarsely until it has rested for a moment. */
  show(view, { moving = false } = {}) {
    this.view = view;
    clearTimeout(this.settleTimer);
    this.rested = !moving;
    if (!moving) return this.#refine();
    this.settleTimer = setTimeout(() => {
      this.rested = true;
      if (!this.previewing) this.#refine();
    }, SETTLE_MS);
    if (!this.previewing) {
      this.#restart();
      this.#preview(this.abort.signal);
    }
  }

  /** Sets the picture's size in pixels. True when it has changed: the view must be shown again then. */
  resize(width, height) {
    if (width === this.canvas.width && height === this.canvas.height) return false;
    const before = document.createElement('canvas');
    before.width = this.canvas.width;
    before.height = this.canvas.height;
    before.getContext('2d').drawImage(this.canvas, 0, 0);
    this.canvas.width = width;
    this.canvas.height = height;
    this.context.drawImage(before, 0, 0, width, height);
    return true;
  }

  /** Asks for no further tiles until resume(); what has gathered stays. */
  pause() {
    if (this.gate) return;
    let open;
    this.gate = new Promise((resolve) => (open = resolve));
    this.gate.open = open;
  }

  resume() {
    this.gate?.open();
    this.gate = null;
  }

  #restart() {
    this.abort.abort();
    this.abort = new AbortController();
    this.previewing = false;
  }

  #report(change) {
    this.status = { ...this.status, ...change };
    this.onStatus(this.status);
  }

  async #preview(signal) {
    this.previewing = true;
    this.#report({ phase: 'moving', samples: 0, message: '' });
    let shown = null;
    try {
      while (shown !== this.view) {
        const view = this.view;
        const frame = {
          width: Math.ceil(this.canvas.width / this.previewScale),
          height: Math.ceil(this.canvas.height / this.previewScale),
        };
        const whole = { x: 0, y: 0, ...frame };
        const started = performance.now();
        const tile = await fetchTile(tileUrl(view, frame, whole, [0, 1]), signal);
        if (signal.aborted) return;
        this.#drawCoarse(tile);
        this.#adaptPreview(performance.now() - started);
        this.#report({ rays: tile.rays, rounded: tile.rounded });
        shown = view;
      }
    } catch (error) {
      // The full picture follows anyway, and says what is wrong if it still is.
      if (error.name !== 'AbortError' && !(error instanceof ServerError)) throw error;
    }
    if (signal.aborted) return;
    this.previewing = false;
    if (this.rested) this.#refine();
  }

  #adaptPreview(milliseconds) {
    if (milliseconds > PREVIEW_MS * 1.4) this.previewScale = Math.min(COARSEST, this.previewScale * 1.25);
    if (milliseconds < PREVIEW_MS * 0.6) this.previewScale = Math.max(FINEST, this.previewScale / 1.15);
  }

  #drawCoarse({ width, height, samples, rgba }) {
    const film = new Film(width, height);
    const whole = { x: 0, y: 0, width, height };
    film.add(whole, rgba, samples);
    this.coarse.width = width;
    this.coarse.height = height;
    this.#drawTile(this.coarse.getContext('2d'), film, whole);
    this.context.imageSmoothingQuality = 'high';
    this.context.drawImage(this.coarse, 0, 0, this.canvas.width, this.canvas.height);
  }

  #drawTile(context, film, tile) {
    const image = context.createImageData(tile.width, tile.height);
    film.display(tile, image.data);
    context.putImageData(image, tile.x, tile.y);
  }

  /** Renders the present view until it has all its samples or another one takes its place. */
  async #refine() {
    this.#restart();
    const { signal } = this.abort;
    const view = this.view;
    const frame = { width: this.canvas.width, height: this.canvas.height };
    const film = new Film(frame.width, frame.height);
    const started = performance.now();
    const progress = { samples: 0, rays: 0, rounded: 0 };
    const report = (phase, message = '') => {
      const seconds = (performance.now() - started) / 1000;
      this.#report({ phase, message, ...progress, seconds });
    };
    const retry = new Retry((seconds, error) => report('waiting', retryText(error, seconds)));

    report('rendering');
    const jobs = renderJobs(frame, this.total);
    const finished = new Map();
    const work = async () => {
      for (let job = jobs.next(); !job.done; job = jobs.next()) {
        const { tile, range, tilesInPass } = job.value;
        await this.gate;
        const result = await retry.run(() => fetchTile(tileUrl(view, frame, tile, range), signal), signal);
        if (signal.aborted) return;
        film.add(tile, result.rgba, result.samples);
        this.#drawTile(this.context, film, tile);
        progress.rays += result.rays;
        progress.rounded += result.rounded;
        finished.set(range[1], (finished.get(range[1]) ?? 0) + 1);
        if (finished.get(range[1]) === tilesInPass) progress.samples = Math.max(progress.samples, range[1]);
        report('rendering');
      }
    };
    try {
      await Promise.all(Array.from({ length: REQUESTS_IN_FLIGHT }, work));
      if (!signal.aborted) report('done');
    } catch (error) {
      if (signal.aborted || error.name === 'AbortError') return;
      this.abort.abort();
      if (!(error instanceof ServerError)) throw error;
      report('failed', error.message);
    }
  }
}

/** Tiles of a frame, pass by pass, in the order in which they are to be asked for. */
function* renderJobs(frame, total) {
  const tiles = tileGrid(frame.width, frame.height, TILE_SIZE);
  for (const range of sampleRanges(total, LONGEST_RANGE)) {
    for (const tile of tiles) yield { tile, range, tilesInPass: tiles.length };
  }
}
