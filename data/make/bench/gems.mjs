// Scene 2: a jeweller's tray, about 103,000 triangles: dice and cut gems of 4 to 40 facets, sorted into compartments, each
// resting on a facet. Lengths in centimetres.
import { box, dot, faceNormal, hull, placed, sub, withUnitInsphere } from '../geometry.mjs';
import { plastic, restingOn } from '../placing.mjs';
import { SOLIDS } from '../solids.mjs';
import { randomFrom } from './random.mjs';

const signs = [-1, 1];
const permuted = ([x, y, z]) => [[x, y, z], [x, z, y], [y, x, z], [y, z, x], [z, x, y], [z, y, x]];
/** All points with these coordinates in any order and with any signs. */
function orbit(point) {
  const all = new Map();
  for (const [x, y, z] of permuted(point))
    for (const a of signs)
      for (const b of signs)
        for (const c of signs) {
          const p = [a * x + 0, b * y + 0, c * z + 0];
          all.set(p.map((v) => v.toFixed(6)).join(), p);
        }
  return [...all.values()];
}
const ringAt = (sides, radius, z, turn) =>
  Array.from({ length: sides }, (_, k) => {
    const angle = (2 * Math.PI * (k + turn)) / sides;
    return [radius * Math.cos(angle), radius * Math.sin(angle), z];
  });

/** Cut gems: convex hulls of rings of corners. The last is a rose cut, flat below. */
const CUTS = {
  ...SOLIDS,
  'truncated-cube': withUnitInsphere(hull(orbit([Math.SQRT2 - 1, 1, 1]))),
  'truncated-octahedron': withUnitInsphere(hull(orbit([0, 1, 2]))),
  cuboctahedron: withUnitInsphere(hull(orbit([1, 1, 0]))),
  rhombicuboctahedron: withUnitInsphere(hull(orbit([1, 1, 1 + Math.SQRT2]))),
  'step-cut': hull([[0.62, -0.42], [0.8, -0.1], [0.8, 0.1], [0.52, 0.36]].flatMap(([r, z]) => ringAt(8, r, z, 0.5))),
  'rose-cut': hull([...ringAt(6, 0.75, -0.35, 0), ...ringAt(6, 0.62, 0.02, 0.5), ...ringAt(6, 0.3, 0.26, 0), [0, 0, 0.35]]),
};
const FACE_DOWN = { 'step-cut': [0, 0, -1], 'rose-cut': [0, 0, -1] }; // others may rest on any face

const metal = (name, base_color, roughness) => ({ name, base_color, roughness, metallic: 1 });
const MATERIALS = [
  plastic('walnut', [0.19, 0.095, 0.045], 0.45),
  plastic('felt', [0.035, 0.05, 0.065], 0.9),
  metal('gold', [0.95, 0.66, 0.26], 0.22),
  metal('copper', [0.9, 0.5, 0.36], 0.26),
  metal('silver', [0.88, 0.87, 0.84], 0.2),
  plastic('ivory', [0.8, 0.74, 0.62]),
  plastic('jade', [0.06, 0.36, 0.2], 0.2),
  plastic('coral', [0.72, 0.16, 0.1], 0.25),
  plastic('lapis', [0.03, 0.09, 0.4], 0.2),
  plastic('turquoise', [0.06, 0.46, 0.48], 0.25),
  plastic('amber', [0.82, 0.4, 0.04], 0.2),
  plastic('onyx', [0.02, 0.02, 0.024], 0.12),
  plastic('rose', [0.72, 0.34, 0.38], 0.3),
  plastic('amethyst', [0.28, 0.1, 0.42], 0.2),
  plastic('garnet', [0.36, 0.012, 0.03], 0.15),
  plastic('pearl', [0.78, 0.77, 0.75], 0.15),
  plastic('emerald', [0.01, 0.24, 0.1], 0.15),
];

/** What lies where: [cut, material], row by row from the front. */
const ROWS = [
  [
    ['cube', 'ivory'], ['rhombicuboctahedron', 'garnet'], ['dodecahedron', 'gold'],
    ['step-cut', 'pearl'], ['octahedron', 'lapis'], ['truncated-cube', 'jade'],
  ],
  [
    ['icosahedron', 'coral'], ['rose-cut', 'emerald'], ['truncated-octahedron', 'turquoise'],
    ['cube', 'copper'], ['step-cut', 'amethyst'], ['trapezohedron', 'amber'],
  ],
  [
    ['tetrahedron', 'silver'], ['dodecahedron', 'lapis'], ['cuboctahedron', 'onyx'],
    ['rose-cut', 'rose'], ['rhombicuboctahedron', 'ivory'], ['icosahedron', 'gold'],
  ],
  [
    ['truncated-cube', 'amber'], ['octahedron', 'jade'], ['cube', 'garnet'],
    ['trapezohedron', 'silver'], ['dodecahedron', 'coral'], ['truncated-octahedron', 'amethyst'],
  ],
  [
    ['step-cut', 'turquoise'], ['cuboctahedron', 'copper'], ['icosahedron', 'ivory'],
    ['rhombicuboctahedron', 'lapis'], ['truncated-cube', 'rose'], ['dodecahedron', 'onyx'],
  ],
];

const INNER = 12.4; // a compartment's side
const BOARD = 0.5; // thickness of the boards between them
const PITCH = INNER + BOARD;

/** The solid, lying on one of its faces on z = 0 with its centre above the origin, and the radius of its shadow. */
function lying(name, random) {
  const solid = CUTS[name];
  const down = FACE_DOWN[name];
  const face = down
    ? solid.faces.findIndex((_, i) => dot(faceNormal(solid, i), down) > 0.999)
    : Math.floor(random.next() * solid.faces.length);
  const drop = dot(faceNormal(solid, face), solid.vertices[solid.faces[face][0]]);
  const stands = placed(solid, restingOn(solid, face, random.between(0, 360)), [0, 0, drop]);
  return stands;
}
const reach = (name) => Math.max(...CUTS[name].vertices.map((v) => Math.hypot(...v)));

/** Rows of stones on a honeycomb in which each has room to turn. */
function* fill([x, y], [cut, material], random) {
  const size = 0.76 / reach(cut) ** 0.35; // small dice a little larger
  const radius = size * reach(cut);
  const spacing = 2 * radius;
  const rise = (spacing * Math.sqrt(3)) / 2;
  for (let j = 0; ; j++) {
    const v = y + radius + j * rise;
    if (v > y + INNER - radius) return;
    for (let i = 0; ; i++) {
      const u = x + radius + (i + (j % 2) / 2) * spacing;
      if (u > x + INNER - radius) break;
      const s = placed(lying(cut, random), [[size, 0, 0], [0, size, 0], [0, 0, size]], [u, v, 0]);
      yield { material, ...s };
    }
  }
}

function* tray() {
  const [nx, ny] = [ROWS[0].length, ROWS.length];
  const [x1, y1, high] = [nx * PITCH, ny * PITCH, 1.3];
  yield { material: 'felt', ...box([-BOARD, -BOARD, -0.8], [x1, y1, 0]) };
  for (let j = 0; j <= ny; j++) {
    const v = j * PITCH - BOARD;
    const edge = j === 0 || j === ny;
    const ends = edge ? [-BOARD, x1] : [0, x1 - BOARD];
    yield { material: 'walnut', ...box([ends[0], v, 0], [ends[1], v + BOARD, edge ? high + 0.4 : high]) };
  }
  for (const i of [0, nx]) {
    const u = i * PITCH - BOARD;
    yield { material: 'walnut', ...box([u, 0, 0], [u + BOARD, y1 - BOARD, high + 0.4]) };
  }
  for (let i = 1; i < nx; i++)
    for (let j = 0; j < ny; j++) {
      const u = i * PITCH - BOARD;
      yield { material: 'walnut', ...box([u, j * PITCH, 0], [u + BOARD, j * PITCH + INNER, high]) };
    }
}

export function gems() {
  const random = randomFrom(103);
  const solids = [
    ...tray(),
    ...ROWS.flatMap((row, j) => row.flatMap((content, i) => [...fill([i * PITCH, j * PITCH], content, random)])),
  ];
  return {
    solids,
    materials: MATERIALS,
    scene: {
      meshes: [
        { name: 'gems', file: 'gems.obj', radius: 0.158 },
        { name: 'ground', file: 'ground.obj', rounding: false },
      ],
      materials: [plastic('table', [0.3, 0.27, 0.24], 0.6)],
      instances: [{ mesh: 'gems' }, { mesh: 'ground', material: 'table', translate: [0, 0, -0.8] }],
      lights: [
        { type: 'area', center: [-20, 70, 70], u: [22, 9, 0], v: [-5, 12, -16], emission: [11, 10.4, 9.4] },
        { type: 'sky', zenith: [0.3, 0.34, 0.4], horizon: [0.5, 0.5, 0.5], ground: [0.15, 0.15, 0.15] },
      ],
      camera: { eye: [36, -16, 27], target: [39.5, 18.5, 0], up: [0, 0, 1], vfov_degrees: 36 },
    },
  };
}
