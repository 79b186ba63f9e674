// The picture as it gathers: the sum of all samples of every pixel, and its way to the screen.

const TABLE_SIZE = 1 << 14;
const SRGB = new Uint8ClampedArray(TABLE_SIZE + 1);
for (let i = 0; i <= TABLE_SIZE; i++) SRGB[i] = 255 * srgbFromLinear(i / TABLE_SIZE);

/** The sRGB transfer function (IEC 61966-2-1), 0..1 to 0..1. */
export function srgbFromLinear(x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
}

/** 8-bit sRGB of a linear value; values beyond the display's range are clipped, NaN is black. */
export function displayByte(linear) {
  const clipped = linear > 1 ? 1 : linear > 0 ? linear : 0;
  return SRGB[Math.round(clipped * TABLE_SIZE)];
}

export class Film {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.sums = new Float32Array(width * height * 3);
    this.counts = new Uint32Array(width * height);
  }

  /** Adds a tile: `rgba` is the mean of `samples` samples of each of its pixels. */
  add({ x, y, width, height }, rgba, samples) {
    for (let row = 0; row < height; row++) {
      let source = row * width * 4;
      let pixel = (y + row) * this.width + x;
      for (let column = 0; column < width; column++, source += 4, pixel++) {
        for (let c = 0; c < 3; c++) this.sums[pixel * 3 + c] += rgba[source + c] * samples;
        this.counts[pixel] += samples;
      }
    }
  }

  /** Linear mean [r, g, b] of a pixel; black before its first sample. */
  mean(x, y) {
    const pixel = y * this.width + x;
    const count = Math.max(this.counts[pixel], 1);
    return [0, 1, 2].map((c) => this.sums[pixel * 3 + c] / count);
  }

  /** Writes a rectangle of the film into `bytes`, RGBA of the rectangle's own size. */
  display({ x, y, width, height }, bytes) {
    let target = 0;
    for (let row = 0; row < height; row++) {
      let pixel = (y + row) * this.width + x;
      for (let column = 0; column < width; column++, pixel++) {
        const scale = 1 / Math.max(this.counts[pixel], 1);
        for (let c = 0; c < 3; c++) bytes[target++] = displayByte(this.sums[pixel * 3 + c] * scale);
        bytes[target++] = 255;
      }
    }
  }
}
