// Scene 1: a ruined temple on its paved square, about 42,000 triangles: columns of 16-sided drums, blocks in courses,
// flagstones, fallen drums. Lengths in metres. Every stone rests on what is below it.
import { box, faceNormal, frustum, loft, placed } from '../geometry.mjs';
import { plastic, restingOn } from '../placing.mjs';
import { cells } from './cells.mjs';
import { randomFrom } from './random.mjs';

const SIDES = 16;
const FLOOR = 0.9; // top of the steps
const COLUMNS = { x: 6, y: 12, pitch: 2.1, drums: 6, drumHeight: 0.86, lower: 0.5, upper: 0.41 };
const BEAM = { width: 0.84, height: 0.6, friezeHeight: 0.5 };
const MATERIALS = [
  plastic('marble', [0.78, 0.74, 0.66], 0.4),
  plastic('honey', [0.72, 0.6, 0.42], 0.45),
  plastic('chalk', [0.82, 0.81, 0.78], 0.4),
  plastic('slab', [0.46, 0.43, 0.39], 0.5),
  plastic('slab-dark', [0.34, 0.32, 0.31], 0.5),
  plastic('slab-warm', [0.52, 0.44, 0.35], 0.5),
];

const [halfX, halfY] = [((COLUMNS.x - 1) * COLUMNS.pitch) / 2, ((COLUMNS.y - 1) * COLUMNS.pitch) / 2];

/** A course of blocks along x from x0 to x1, each second course shifted by half a block. */
function course([x0, x1], [y0, y1], [z0, z1], length, shifted) {
  const ends = [x0];
  for (let x = x0 + (shifted ? length / 2 : length); x < x1 - length / 4; x += length) ends.push(x);
  ends.push(x1);
  return ends.slice(1).map((x, i) => box([ends[i], y0, z0], [x, y1, z1]));
}
const turned = (solid) => placed(solid, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [0, 0, 0]); // x to y, y to -x

function* steps(random) {
  for (let level = 0; level < 3; level++) {
    const [x, y] = [halfX + 1.9 - 0.45 * level, halfY + 1.9 - 0.45 * level];
    const rows = Math.round((2 * y) / 1.3);
    for (let row = 0; row < rows; row++) {
      const along = [-y + (2 * y * row) / rows, -y + (2 * y * (row + 1)) / rows];
      for (const stone of course([-x, x], along, [0.3 * level, 0.3 * (level + 1)], 2.2, row % 2 === 1))
        yield { material: random.among(['marble', 'marble', 'chalk', 'honey']), ...stone };
    }
  }
}

/** Places of the columns, around the edge of the floor in order, and how many drums of each still stand. */
function columns() {
  const places = [];
  for (let i = 0; i < COLUMNS.x; i++) places.push([i, 0]);
  for (let j = 1; j < COLUMNS.y; j++) places.push([COLUMNS.x - 1, j]);
  for (let i = COLUMNS.x - 2; i >= 0; i--) places.push([i, COLUMNS.y - 1]);
  for (let j = COLUMNS.y - 2; j > 0; j--) places.push([0, j]);
  const standing = new Map([['4,0', 4], ['5,0', 2], ['5,1', 5], ['5,2', 3], ['5,5', 4], ['0,8', 3], ['2,11', 4]]);
  return places.map(([i, j]) => ({
    at: [i * COLUMNS.pitch - halfX, j * COLUMNS.pitch - halfY],
    drums: standing.get(`${i},${j}`) ?? COLUMNS.drums,
  }));
}

const radiusAt = (drum) => COLUMNS.lower + ((COLUMNS.upper - COLUMNS.lower) * drum) / COLUMNS.drums;
const capitalTop = FLOOR + COLUMNS.drums * COLUMNS.drumHeight + 0.26;
const abacusTop = capitalTop + 0.18;

function* column({ at, drums }, material) {
  for (let d = 0; d < drums; d++) {
    const z = FLOOR + d * COLUMNS.drumHeight;
    yield { material, ...frustum(SIDES, radiusAt(d), radiusAt(d + 1), at, z, z + COLUMNS.drumHeight) };
  }
  if (drums < COLUMNS.drums) return;
  const [x, y] = at;
  yield { material, ...frustum(SIDES, COLUMNS.upper, 0.6, at, capitalTop - 0.26, capitalTop) };
  yield { material, ...box([x - 0.6, y - 0.6, capitalTop], [x + 0.6, y + 0.6, abacusTop]) };
}

/** Beams from column to column wherever both stand, and the frieze upon them. */
function* beams(all) {
  const w = BEAM.width / 2;
  for (let k = 0; k < all.length; k++) {
    const [a, b] = [all[k], all[(k + 1) % all.length]];
    if (a.drums < COLUMNS.drums || b.drums < COLUMNS.drums) continue;
    const alongX = a.at[1] === b.at[1];
    const axis = alongX ? 0 : 1;
    const [low, high] = [a.at[axis], b.at[axis]].sort((p, q) => p - q);
    const side = a.at[1 - axis];
    // At the corners the beams along x reach out to the far side, those along y stop short.
    const end = (v) => (Math.abs(v) > (alongX ? halfX : halfY) - 1e-6 ? (alongX ? 1 : -1) * Math.sign(v) * w : 0);
    const [from, to] = [low + end(low), high + end(high)];
    const stone = (u0, u1, z0, z1) =>
      alongX ? box([u0, side - w, z0], [u1, side + w, z1]) : box([side - w, u0, z0], [side + w, u1, z1]);
    const z = abacusTop + BEAM.height;
    yield { material: k % 3 === 0 ? 'honey' : 'marble', ...stone(from, to, abacusTop, z) };
    for (let i = 0; i < 4; i++) {
      const [u0, u1] = [from + ((to - from) * i) / 4, from + ((to - from) * (i + 1)) / 4];
      yield { material: i % 2 === 0 ? 'chalk' : 'honey', ...stone(u0, u1, z, z + BEAM.friezeHeight) };
    }
  }
}

/** The walls of the inner room, with its door to the front; their upper courses have crumbled in steps. */
function* walls(random) {
  const [x, y, thick, high] = [halfX - 1.7, halfY - 2.6, 0.6, 0.45];
  for (let i = 0; i < 12; i++) {
    const z = [FLOOR + i * high, FLOOR + (i + 1) * high];
    const odd = i % 2 === 1;
    // Each second course the long walls and the short ones take turns at the corners.
    const [endX, endY] = odd ? [x - thick, y] : [x, y - thick];
    const long = [-x, x - thick].flatMap((wall) => course([-endY, endY], [-wall - thick, -wall], z, 1.3, odd).map(turned));
    const back = course([-endX, endX], [y - thick, y], z, 1.3, odd);
    const front = i < 9
      ? [...course([-endX, -0.9], [-y, -y + thick], z, 1.3, odd), ...course([0.9, endX], [-y, -y + thick], z, 1.3, !odd)]
      : i === 9
        ? [[-endX, -1.4], [-1.4, 1.4], [1.4, endX]].map(([x0, x1]) => box([x0, -y, z[0]], [x1, -y + thick, z[1]])) // the lintel
        : course([-endX, endX], [-y, -y + thick], z, 1.3, odd);
    for (const stone of [...long, ...back, ...front]) {
      const [cx, cy] = [(stone.vertices[0][0] + stone.vertices[6][0]) / 2, (stone.vertices[0][1] + stone.vertices[6][1]) / 2];
      const ruined = i > 4 && cx > x - 2.2 - 0.5 * (i - 5) && cy < -y + 1.4 * (i - 4) && cx > 1.2;
      if (!ruined) yield { material: random.among(['honey', 'honey', 'marble']), ...stone };
    }
  }
}

/** Drums that have rolled away: each lies on one of its sides, on the flagstones (z = 0). */
const FALLEN = [
  // drum, x, y, spin
  [2, 4.1, -16.6, 20], [3, 6.6, -15.5, 75], [1, 8.9, -12.6, -35], [4, 8.6, -9.4, 12], [5, 2.2, -18.3, -62],
  [2, 9.6, -4.2, 50], [0, 6.3, -18.1, -15],
];
function* fallen() {
  for (const [drum, x, y, spin] of FALLEN) {
    const solid = frustum(SIDES, radiusAt(drum), radiusAt(drum + 1), [0, 0], 0, COLUMNS.drumHeight);
    const face = 2 + ((drum * 5) % SIDES); // one of the sides
    const drop = -faceNormal(solid, face).reduce((sum, n, i) => sum + n * solid.vertices[solid.faces[face][0]][i], 0);
    yield { material: 'marble', ...placed(solid, restingOn(solid, face, spin), [x, y, -drop]) };
  }
}

function* paving(random) {
  const thickness = 0.25;
  for (const { polygon } of cells([-17, -24.5], [17, 18], { size: 1.305, gap: 0.05, jitter: 0.75, random })) {
    yield { material: random.among(['slab', 'slab', 'slab-dark', 'slab-warm']), ...loft(polygon, polygon, -thickness, 0) };
  }
}

export function temple() {
  const random = randomFrom(42);
  const all = columns();
  const solids = [
    ...paving(random),
    ...steps(random),
    ...all.flatMap((c, i) => [...column(c, i % 4 === 1 ? 'chalk' : 'marble')]),
    ...beams(all),
    ...walls(random),
    ...fallen(),
  ];
  return {
    solids,
    materials: MATERIALS,
    scene: {
      meshes: [
        { name: 'temple', file: 'temple.obj', radius: 0.025 },
        { name: 'ground', file: 'ground.obj', rounding: false },
      ],
      materials: [plastic('earth', [0.3, 0.26, 0.2], 0.9)],
      instances: [{ mesh: 'temple' }, { mesh: 'ground', material: 'earth', translate: [0, 0, -0.25] }],
      lights: [
        { type: 'directional', direction: [0.62, 0.55, -0.62], irradiance: [2.2, 1.9, 1.5], angular_diameter_degrees: 2 },
        { type: 'sky', zenith: [0.14, 0.23, 0.42], horizon: [0.42, 0.46, 0.5], ground: [0.2, 0.18, 0.15] },
      ],
      camera: { eye: [-8.2, -25.5, 4.2], target: [1.4, -9, 2.5], up: [0, 0, 1], vfov_degrees: 36 },
    },
  };
}
