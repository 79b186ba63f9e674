// From films to canvases: tiles, whole pictures, coarse ones.
import { Film } from './film.js';

const whole = ({ width, height }) => ({ x: 0, y: 0, width, height });

export class Painter {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false });
    this.coarse = document.createElement('canvas');
  }

  /** Sets the canvas' size in pixels and keeps what it shows; true when it has changed. */
  resize(width, height) {
    const { canvas } = this;
    if (width === canvas.width && height === canvas.height) return false;
    const before = document.createElement('canvas');
    before.width = canvas.width;
    before.height = canvas.height;
    before.getContext('2d').drawImage(canvas, 0, 0);
    canvas.width = width;
    canvas.height = height;
    this.context.drawImage(before, 0, 0, width, height);
    return true;
  }

  /** `source` has display(rectangle, bytes): a Film or a Difference of the canvas' size. */
  tile(source, rectangle, context = this.context) {
    const image = context.createImageData(rectangle.width, rectangle.height);
    source.display(rectangle, image.data);
    context.putImageData(image, rectangle.x, rectangle.y);
  }

  all(source) {
    this.tile(source, whole(this.canvas));
  }

  /** A smaller source, drawn over all of the canvas. */
  enlarged(source) {
    this.coarse.width = source.width;
    this.coarse.height = source.height;
    this.tile(source, whole(source), this.coarse.getContext('2d'));
    this.context.imageSmoothingQuality = 'high';
    this.context.drawImage(this.coarse, 0, 0, this.canvas.width, this.canvas.height);
  }

  clear(color) {
    this.context.fillStyle = color;
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
  }
}

/** The film of a tile that is a whole picture. */
export function filmOf({ width, height, samples, rgba }) {
  const film = new Film(width, height);
  film.add(whole(film), rgba, samples);
  return film;
}

/** What is seen of two canvases that are compared, in one: for saving. */
export function seenPicture({ mode, split }, { a, b, difference }) {
  if (mode === 'off') return a;
  if (mode === 'difference') return difference;
  const seen = document.createElement('canvas');
  const { width, height } = a;
  const isBelow = mode === 'beside' && b.offsetTop > 0;
  seen.width = mode === 'beside' && !isBelow ? 2 * width : width;
  seen.height = isBelow ? 2 * height : height;
  const context = seen.getContext('2d');
  context.drawImage(a, 0, 0);
  if (mode === 'beside') {
    context.drawImage(b, isBelow ? 0 : width, isBelow ? height : 0);
  } else {
    const left = Math.round((split / 100) * width);
    if (left < width) context.drawImage(b, left, 0, width - left, height, left, 0, width - left, height);
  }
  return seen;
}
