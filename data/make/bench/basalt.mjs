// Scene 3: a coast of basalt columns, about 252,000 triangles: thousands of four- to eight-sided prisms of different heights,
// cracked across here and there, rising from a shore to a cliff. Lengths in metres.
import { loft } from '../geometry.mjs';
import { plastic } from '../placing.mjs';
import { cells } from './cells.mjs';
import { randomFrom } from './random.mjs';

const SIZE = 0.68; // a column's width
const FOOT = -1.5; // all columns go down to the sea bed
const MATERIALS = [
  plastic('basalt', [0.13, 0.13, 0.135], 0.38),
  plastic('basalt-pale', [0.21, 0.205, 0.2], 0.42),
  plastic('basalt-brown', [0.2, 0.16, 0.12], 0.45),
  plastic('lichen', [0.27, 0.26, 0.16], 0.6),
];

const bump = (x, y, [cx, cy], width, height) => height * Math.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * width * width));

/** Heads of rock: [x, y], width, height. */
const HEADS = [[[-8, 12], 3.2, 6.5], [[6, 21], 4.2, 7], [[12, 7], 2.4, 3.6], [[-3.5, 3.5], 1.8, 0.9]];

/** The coast's shape: flat steps by the water, a few heads of rock, a cliff behind. */
function ground(x, y) {
  const shore = 0.05 * (y + 4) + 0.35 * Math.sin(x * 0.23 + 0.7) * Math.sin(y * 0.19 - 0.4);
  const heads = HEADS.reduce((sum, [at, width, height]) => sum + bump(x, y, at, width, height), 0);
  const cliff = 9 / (1 + Math.exp(-(y - 33 - 3 * Math.sin(x * 0.15)) / 1.6));
  return shore + heads + cliff;
}

export function basalt() {
  const random = randomFrom(252);
  const solids = [];
  for (const { centre, polygon } of cells([-26.6, -9], [26.6, 41], { size: SIZE, gap: 0.025, jitter: 0.55, random })) {
    const [cx, cy] = centre;
    const height = Math.round((ground(cx, cy) + random.between(-0.15, 0.15)) / 0.3) * 0.3 + random.between(-0.03, 0.03);
    if (height < -0.55) continue; // drowned
    // The top lies a little askew; a crack parts it from the rest of the column.
    const tilt = [random.between(-0.1, 0.1), random.between(-0.1, 0.1)];
    const top = (x, y) => height + tilt[0] * (x - cx) + tilt[1] * (y - cy);
    const high = height > 2.2 && random.next() < 0.5;
    const material = random.next() < Math.min(0.22, 0.04 * Math.max(0, height)) ? 'lichen'
      : random.among(['basalt', 'basalt', 'basalt-pale', 'basalt-brown']);
    const crack = height - random.between(0.3, high ? 1.4 : 0.8);
    solids.push({ material, ...loft(polygon, polygon, FOOT, crack) });
    solids.push({ material, ...loft(polygon, polygon, crack, top) });
  }
  return {
    solids,
    materials: MATERIALS,
    scene: {
      meshes: [
        { name: 'basalt', file: 'basalt.obj', radius: 0.028 },
        { name: 'ground', file: 'ground.obj', rounding: false },
      ],
      materials: [{ name: 'sea', base_color: [0.02, 0.05, 0.06], roughness: 0.08, metallic: 0, ior: 1.33 }],
      instances: [{ mesh: 'basalt' }, { mesh: 'ground', material: 'sea', translate: [0, 0, -0.35] }],
      lights: [
        { type: 'directional', direction: [0.75, 0.5, -0.5], irradiance: [3.4, 2.8, 2.1], angular_diameter_degrees: 2 },
        { type: 'sky', zenith: [0.17, 0.27, 0.46], horizon: [0.6, 0.58, 0.55], ground: [0.1, 0.1, 0.1] },
      ],
      camera: { eye: [-1.5, -11.5, 2.9], target: [0.4, 6, 1.1], up: [0, 0, 1], vfov_degrees: 42 },
    },
  };
}
