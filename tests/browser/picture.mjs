// What the canvas shows, reduced to block means so that the noise of few samples does not count.

const BLOCK = 8; // pixels a side

/** Waits until the page has at least `samples` of every pixel of its present view, or all of them. */
export async function waitForSamples(page, samples) {
  await page.waitForFunction(
    (wanted) => {
      const found = document.getElementById('status').textContent.match(/(Rendering|Done): (\d+) of/);
      return found && Number(found[2]) >= wanted;
    },
    samples,
    { timeout: 90_000 },
  );
}

/** Mean red, green, blue of every block of 8x8 pixels of the canvas: {columns, rows, means: number[]}. */
export function blockMeans(page) {
  return page.evaluate((block) => {
    const canvas = document.getElementById('picture');
    // Read from a copy: reading the page's own canvas again and again would change how the browser keeps it.
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const [columns, rows] = [Math.floor(canvas.width / block), Math.floor(canvas.height / block)];
    const means = new Array(columns * rows * 3).fill(0);
    for (let y = 0; y < rows * block; y++) {
      for (let x = 0; x < columns * block; x++) {
        const target = (Math.floor(y / block) * columns + Math.floor(x / block)) * 3;
        for (let c = 0; c < 3; c++) means[target + c] += data[(y * canvas.width + x) * 4 + c] / block ** 2;
      }
    }
    return { columns, rows, means };
  }, BLOCK);
}

/** Standard deviation over the blocks, 0 for a picture of one colour. */
export function contrast({ means }) {
  const mean = means.reduce((sum, x) => sum + x, 0) / means.length;
  return Math.sqrt(means.reduce((sum, x) => sum + (x - mean) ** 2, 0) / means.length);
}

/** Share of blocks that differ by more than `threshold` of 255 in a channel. */
export function changedShare(a, b, threshold = 12) {
  if (a.columns !== b.columns || a.rows !== b.rows) throw new Error('the pictures differ in size');
  let changed = 0;
  for (let i = 0; i < a.means.length; i += 3) {
    if ([0, 1, 2].some((c) => Math.abs(a.means[i + c] - b.means[i + c]) > threshold)) changed++;
  }
  return changed / (a.columns * a.rows);
}
