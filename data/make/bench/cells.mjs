// Plane cells for paving and columns: the Voronoi cells of a jittered honeycomb, shrunk so that neighbours stay apart.

/** Part of a convex polygon where n.p <= d. */
function clip(polygon, [nx, ny], d) {
  const kept = [];
  const height = ([x, y]) => nx * x + ny * y - d;
  polygon.forEach((a, i) => {
    const b = polygon[(i + 1) % polygon.length];
    const ha = height(a);
    const hb = height(b);
    if (ha <= 0) kept.push(a);
    if (ha < 0 !== hb < 0 && ha !== hb) {
      const t = ha / (ha - hb);
      kept.push([a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
    }
  });
  return kept;
}

/** Drops corners until no edge is shorter than `least`: what is left is still convex. */
function withoutShortEdges(polygon, least) {
  const kept = polygon.slice();
  for (let i = 0; i < kept.length && kept.length > 3; ) {
    const a = kept[i];
    const b = kept[(i + 1) % kept.length];
    if (Math.hypot(b[0] - a[0], b[1] - a[1]) < least) kept.splice((i + 1) % kept.length, 1);
    else i++;
  }
  return kept;
}

const areaOf = (polygon) =>
  polygon.reduce((sum, [x, y], i) => {
    const [u, v] = polygon[(i + 1) % polygon.length];
    return sum + (x * v - u * y) / 2;
  }, 0);

/** Cells over the rectangle from (x0, y0) to (x1, y1), each {centre, polygon}: convex, counter-clockwise, `gap` apart,
 * about `size` wide; `jitter` 0 gives a honeycomb, 1 a wild one. */
export function cells([x0, y0], [x1, y1], { size, gap, jitter, random }) {
  const rise = (size * Math.sqrt(3)) / 2;
  const columns = Math.ceil((x1 - x0) / size) + 2;
  const rows = Math.ceil((y1 - y0) / rise) + 2;
  const seeds = [];
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < columns; i++) {
      const shift = j % 2 === 0 ? 0 : 0.5;
      const [dx, dy] = [0, 1].map(() => (random.next() - 0.5) * jitter * size);
      seeds.push([x0 + (i - 0.5 + shift) * size + dx, y0 + (j - 0.5) * rise + dy]);
    }
  }
  const frame = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  const all = [];
  seeds.forEach((seed, k) => {
    if (seed[0] < x0 || seed[0] > x1 || seed[1] < y0 || seed[1] > y1) return;
    let polygon = frame;
    const [i, j] = [k % columns, Math.floor(k / columns)];
    for (let v = Math.max(0, j - 3); v <= Math.min(rows - 1, j + 3); v++) {
      for (let u = Math.max(0, i - 3); u <= Math.min(columns - 1, i + 3); u++) {
        const other = seeds[v * columns + u];
        if (other === seed) continue;
        const apart = Math.hypot(other[0] - seed[0], other[1] - seed[1]);
        const n = [(other[0] - seed[0]) / apart, (other[1] - seed[1]) / apart];
        polygon = clip(polygon, n, n[0] * seed[0] + n[1] * seed[1] + apart / 2 - gap / 2);
      }
    }
    polygon = withoutShortEdges(polygon, 0.12 * size);
    // A sliver at the frame's edge is no stone.
    if (areaOf(polygon) > 0.3 * size * size) all.push({ centre: seed, polygon });
  });
  return all;
}
