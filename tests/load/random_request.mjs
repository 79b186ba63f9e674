// Valid requests of every kind that a scene takes, at random: cameras, radii, roundings, formats, sample ranges, AOVs,
// frames and batches of rays. The work of each is small, so that many fit into a minute.
const MODES = ['analytic', 'analytic', 'analytic', 'analytic', 'none', 'mesh:1', 'mesh:3', 'bevel:4'];
const AOVS = ['beauty', 'beauty', 'beauty', 'albedo', 'normal', 'depth', 'feature'];

/** `scene`: an element of /v1/scenes. Returns method, path, headers and body for ask(). */
export function randomRequest(random, scene) {
  const whole = (low, high) => low + Math.floor(random() * (high - low + 1));
  const one = (list) => list[whole(0, list.length - 1)];
  const { min, max } = scene.bounds;
  const centre = min.map((low, i) => (low + max[i]) / 2);
  const size = Math.hypot(...min.map((low, i) => max[i] - low));
  /** A point within `reach` diagonals of the centre, in each coordinate. */
  const near = (reach) => centre.map((c) => c + (random() * 2 - 1) * reach * size);
  const rounding = () => {
    const mode = one(MODES);
    // A few radii come often, most are new: the cache of prepared scenes has hits and has to let go.
    const radius = scene.radius.max * (random() < 0.5 ? one([0.25, 0.5, 0.75]) : 0.05 + 0.9 * random());
    return { mode, radius: mode !== 'none' && scene.radius.max && random() < 0.6 ? radius : undefined };
  };

  const base = `/v1/scenes/${scene.id}`;
  if (random() < 0.15) {
    const { mode, radius } = rounding();
    const rays = Array.from({ length: whole(1, 200) }, () => {
      const from = near(1.5);
      return [...from, ...near(0.4).map((to, i) => to - from[i])];
    });
    const body = JSON.stringify({ rays, rounding: mode, radius, tnear: one([undefined, 0, 0.1]) });
    return { method: 'POST', path: `${base}/rays`, headers: { 'Content-Type': 'application/json' }, body };
  }

  const query = [];
  if (random() < 0.7) {
    const lens = random() < 0.2 ? [0.01 * size, size] : [];
    query.push(`camera=${[...near(1.5), ...near(0.2), 0.1, 0.2, 1, 20 + 60 * random(), ...lens].join(',')}`);
  }
  const { mode, radius } = rounding();
  if (mode !== 'analytic' || random() < 0.5) query.push(`rounding=${encodeURIComponent(mode)}`);
  if (radius) query.push(`radius=${radius}`);
  if (random() < 0.5) query.push(`seed=${whole(0, 99)}`);
  if (random() < 0.5) query.push(`bounces=${whole(0, 12)}`);
  if (random() < 0.5) query.push(`aov=${one(AOVS)}`);
  const [width, height] = [whole(8, 320), whole(8, 320)];
  const first = whole(0, 40);
  const samples = `${first}-${first + whole(1, 3)}`;
  let resource = `frames/${whole(8, 40)}x${whole(8, 40)}/${samples}.${one(['exr', 'png'])}`;
  if (random() < 0.9) {
    const [w, h] = [whole(1, Math.min(width, 40)), whole(1, Math.min(height, 40))];
    const rectangle = [whole(0, width - w), whole(0, height - h), w, h].join(',');
    resource = `tiles/${width}x${height}/${rectangle}/${samples}.${one(['f16', 'exr', 'png'])}`;
  }
  return { method: 'GET', path: `${base}/${resource}${query.length > 0 ? `?${query.join('&')}` : ''}` };
}
