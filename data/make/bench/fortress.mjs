// Blocks: a fortress laid brick by brick, about 276,000 triangles. Straight walls are bricks in running bond, towers are rings of
// wedge-shaped ones; courses turn by half a brick. Lengths in brick lengths. Bricks touch, none overlaps, none floats.
import { box, loft, placed } from '../geometry.mjs';
import { plastic } from '../placing.mjs';
import { randomFrom } from './random.mjs';

const [LENGTH, DEPTH, HEIGHT] = [1, 0.5, 0.34];
const MATERIALS = [
  plastic('clay', [0.5, 0.19, 0.1], 0.5),
  plastic('clay-dark', [0.36, 0.12, 0.075], 0.5),
  plastic('clay-pale', [0.6, 0.3, 0.18], 0.5),
  plastic('sand', [0.66, 0.55, 0.38], 0.5),
  plastic('slate', [0.22, 0.23, 0.26], 0.45),
  plastic('slate-pale', [0.32, 0.33, 0.35], 0.45),
];
const CLAY = ['clay', 'clay', 'clay', 'clay-dark', 'clay-pale'];

/** Bricks along x from x0 to x1, `shifted` ones half a brick on; `open(x0, x1)`: where none is laid. */
function* row([x0, x1], [y0, y1], z, shifted, open = () => false) {
  let x = x0;
  while (x < x1 - 1e-9) {
    const next = Math.min(x1, x + (shifted && x === x0 ? LENGTH / 2 : LENGTH));
    if (!open(x, next)) yield box([x, y0, z], [next, y1, z + HEIGHT]);
    x = next;
  }
}

/** One course of a round wall: wedge-shaped bricks between two radii about (cx, cy). */
function* ringCourse([cx, cy], [r0, r1], z, count, shifted, open = () => false) {
  for (let k = 0; k < count; k++) {
    if (open(k)) continue;
    const [a, b] = [k, k + 1].map((i) => (2 * Math.PI * (i + (shifted ? 0.5 : 0))) / count);
    const at = (r, angle) => [cx + r * Math.cos(angle), cy + r * Math.sin(angle)];
    const wedge = [at(r0, a), at(r1, a), at(r1, b), at(r0, b)];
    yield loft(wedge, wedge, z, z + HEIGHT);
  }
}

/** A round tower with slits, a wider parapet and merlons. */
function* tower(at, radius, courses, random) {
  const count = 2 * Math.round(Math.PI * radius);
  const slit = (c) => (k) => c % 13 > 7 && c % 13 < 11 && k % Math.round(count / 5) === Math.floor(c / 13);
  for (let c = 0; c < courses; c++) {
    const band = c % 13 === 12;
    // Both leaves break at the same angles: the chords of a ring cut into its neighbour's anywhere else.
    const shifted = c % 2 === 1;
    for (const s of ringCourse(at, [radius - 2 * DEPTH, radius - DEPTH], c * HEIGHT, count, shifted))
      yield { material: random.among(CLAY), ...s };
    for (const s of ringCourse(at, [radius - DEPTH, radius], c * HEIGHT, count, shifted, slit(c)))
      yield { material: band ? 'sand' : random.among(CLAY), ...s };
  }
  const wide = radius + 0.3;
  for (let c = courses; c < courses + 6; c++) {
    const merlon = c >= courses + 3;
    const open = merlon ? (k) => k % 4 >= 2 : undefined;
    for (const s of ringCourse(at, [wide - 2 * DEPTH, wide], c * HEIGHT, count, false, open))
      yield { material: c === courses ? 'sand' : random.among(CLAY), ...s };
  }
}

/** A straight wall of two leaves of brick from (0, 0) along x, with merlons; `gate` [from, to, courses] is left open. */
function* wall(length, courses, random, gate) {
  for (let c = 0; c < courses + 6; c++) {
    const merlon = c >= courses + 3;
    const z = c * HEIGHT;
    // An arch of corbels: the gate narrows by half a brick a course once it is high.
    const narrower = gate ? Math.max(0, c - gate[2]) * 0.25 : 0;
    const inGate = (x) => gate && x > gate[0] + narrower && x < gate[1] - narrower;
    const open = (x0, x1) => (merlon && Math.floor(x0 / 1.5 + 1e-9) % 2 === 1) || inGate((x0 + x1) / 2);
    for (let leaf = 0; leaf < (c < courses ? 2 : 1); leaf++) {
      const y = [leaf * DEPTH, (leaf + 1) * DEPTH];
      for (const s of row([0, length], y, z, !merlon && (c + leaf) % 2 === 1, open))
        yield { material: c === courses ? 'sand' : random.among(CLAY), ...s };
    }
  }
}

/** A yard of slates in herringbone-like rows on the ground. */
function* yard([x0, y0], [x1, y1], random) {
  for (let j = 0; y0 + (j + 1) * DEPTH <= y1; j++)
    for (const s of row([x0, x1], [y0 + j * DEPTH, y0 + (j + 1) * DEPTH], -HEIGHT, j % 2 === 1))
      yield { material: random.among(['slate', 'slate', 'slate-pale']), ...s };
}

const SIDE = 34; // between the corner towers' centres
const ABOUT_Z = [
  [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
  [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
  [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
];

export function fortress() {
  const random = randomFrom(276);
  const h = SIDE / 2;
  const corners = [[-h, -h], [h, -h], [h, h], [-h, h]];
  const radius = 4;
  const walls = corners.flatMap(([x, y], side) => {
    // Starts where the tower ends. The bricks' outer leaf faces away from the yard.
    const along = ABOUT_Z[side].map((r) => r[0]);
    const inwards = ABOUT_Z[side].map((r) => r[1]);
    const start = [x, y, 0].map((v, i) => v + along[i] * radius - inwards[i] * 0.5);
    const gate = side === 0 ? [11, 17, 14] : undefined;
    return [...wall(SIDE - 2 * radius, 26, random, gate)].map((s) => ({ ...s, ...placed(s, ABOUT_Z[side], start) }));
  });
  const solids = [
    ...yard([-h - 5, -h - 5], [h + 5, h + 5], random),
    ...walls,
    ...corners.flatMap((at, i) => [...tower(at, radius, [36, 36, 48, 36][i], random)]),
    ...tower([4, 4], 5, 55, random),
    ...tower([-9, 6], 3, 36, random),
  ];
  return {
    solids,
    materials: MATERIALS,
    scene: {
      meshes: [
        { name: 'fortress', file: 'fortress.obj', radius: 0.009 },
        { name: 'ground', file: 'ground.obj', rounding: false },
      ],
      materials: [plastic('sand-floor', [0.42, 0.37, 0.28], 0.8)],
      instances: [{ mesh: 'fortress' }, { mesh: 'ground', material: 'sand-floor', translate: [0, 0, -HEIGHT] }],
      lights: [
        { type: 'directional', direction: [0.8, 0.62, -0.62], irradiance: [2.7, 2.35, 1.9], angular_diameter_degrees: 2 },
        { type: 'sky', zenith: [0.16, 0.25, 0.45], horizon: [0.45, 0.48, 0.5], ground: [0.2, 0.18, 0.15] },
      ],
      camera: { eye: [-27, -56, 27], target: [0.5, -1, 7], up: [0, 0, 1], vfov_degrees: 36 },
    },
  };
}
