// Where and by how much two pictures differ: the largest |A - B| of a pixel's channels, on the scale and in the colours of the
// comparison reports' heat map (server/jobs/report/color_map.cpp).

export const DECADES = 3; // the scale is logarithmic, and this many powers of ten long
/** Colours at equal distances of the scale. */
const POINTS = [0x000004, 0x1d1147, 0x51127c, 0x822681, 0xb63679, 0xe65164, 0xfb8861, 0xfec287, 0xfcfdbf];
export const UNKNOWN = [0x4a, 0x4e, 0x54];
const STEPS = 1024;

const channelsOf = (rgb) => [rgb >> 16, (rgb >> 8) & 0xff, rgb & 0xff];
const COLORS = new Uint8ClampedArray((STEPS + 1) * 3);
for (let i = 0; i <= STEPS; i++) {
  const place = (i / STEPS) * (POINTS.length - 1);
  const first = Math.min(Math.floor(place), POINTS.length - 2);
  const [from, to] = [channelsOf(POINTS[first]), channelsOf(POINTS[first + 1])];
  for (let c = 0; c < 3; c++) COLORS[3 * i + c] = from[c] + (place - first) * (to[c] - from[c]);
}

/** The same colours for a style sheet. */
export const gradient = POINTS.map((rgb) => `#${rgb.toString(16).padStart(6, '0')}`).join(', ');

/** The next of ... 0.1, 0.2, 0.5, 1, 2, 5 ... that is no less: the scale changes in steps, not with every tile. */
export function roundedUp(value) {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  const step = [1, 2, 5, 10].find((x) => x * power >= value * (1 - 1e-6));
  return Number((step * power).toPrecision(1));
}

/** What the scale's ticks say, from its dark end; none without a difference. */
export function ticks(top) {
  if (!(top > 0)) return [];
  const texts = Array.from({ length: DECADES + 1 }, (_, i) => String(Number((top / 10 ** (DECADES - i)).toPrecision(1))));
  texts[0] = `≤ ${texts[0]}`;
  return texts;
}

export class Difference {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.values = new Float32Array(width * height).fill(NaN); // NaN: not known yet
    this.largest = new Map(); // by tile
    this.top = 0; // of the scale
  }

  /** Takes a rectangle of two films of this size; true: the scale is another, so that everything is to be shown anew. */
  update({ x, y, width, height }, a, b) {
    let largest = 0;
    for (let row = y; row < y + height; row++) {
      for (let pixel = row * this.width + x; pixel < row * this.width + x + width; pixel++) {
        const value = differenceAt(a, b, pixel);
        this.values[pixel] = value;
        if (value > largest) largest = value;
      }
    }
    this.largest.set(`${x},${y}`, largest);
    const top = roundedUp(Math.max(...this.largest.values()));
    const isOther = top !== this.top;
    this.top = top;
    return isOther;
  }

  /** Writes a rectangle's colours into `bytes`, RGBA of the rectangle's own size. */
  display({ x, y, width, height }, bytes) {
    const scale = this.top > 0 ? 1 / this.top : 0;
    let target = 0;
    for (let row = y; row < y + height; row++) {
      for (let pixel = row * this.width + x; pixel < row * this.width + x + width; pixel++, target += 4) {
        const value = this.values[pixel];
        bytes[target + 3] = 255;
        if (Number.isNaN(value)) {
          for (let c = 0; c < 3; c++) bytes[target + c] = UNKNOWN[c];
          continue;
        }
        const place = value > 0 ? Math.max(0, Math.min(1, 1 + Math.log10(value * scale) / DECADES)) : 0;
        const step = Math.round(place * STEPS) * 3;
        for (let c = 0; c < 3; c++) bytes[target + c] = COLORS[step + c];
      }
    }
  }
}

function differenceAt(a, b, pixel) {
  const [countA, countB] = [a.counts[pixel], b.counts[pixel]];
  if (countA === 0 || countB === 0) return NaN;
  let largest = 0;
  for (let c = 3 * pixel; c < 3 * pixel + 3; c++) {
    largest = Math.max(largest, Math.abs(a.sums[c] / countA - b.sums[c] / countB));
  }
  return largest;
}
