// The scene files, and the few meshes that only scenes use. Frame: z up, right-handed; angles in degrees.
import { BRICK_HEIGHT, BRICKS, PLATE_HEIGHT } from './bricks.mjs';
import { add, box, cross, dot, faceNormal, obj, scale, unit } from './geometry.mjs';
import { SOLIDS } from './solids.mjs';

const round = (x) => Number(x.toFixed(9)) + 0;

/** 4x4 row-major, from a 3x3 matrix (rows) and a translation. */
const matrix = (rows, t) => [...rows.flatMap((row, i) => [...row, t[i]]), 0, 0, 0, 1].map(round);

function rotationAbout(axis, degrees) {
  const [x, y, z] = unit(axis);
  const c = Math.cos((degrees * Math.PI) / 180);
  const s = Math.sin((degrees * Math.PI) / 180);
  return [
    [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
    [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
    [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
  ];
}

const times = (a, b) => a.map((row) => [0, 1, 2].map((j) => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]));

/** Rotation that lays face `index` of a solid on the ground, then spins it about z. */
function restingOn(solid, index, spinDegrees) {
  const down = faceNormal(solid, index);
  const axis = cross(down, [0, 0, -1]);
  const cosine = -down[2];
  const tilt =
    Math.hypot(...axis) < 1e-9
      ? rotationAbout([1, 0, 0], cosine > 0 ? 0 : 180)
      : rotationAbout(axis, (Math.acos(Math.max(-1, Math.min(1, cosine))) * 180) / Math.PI);
  return times(rotationAbout([0, 0, 1], spinDegrees), tilt);
}

/** An even sky: it fills the shadows and leaves the modelling to the lamp. */
const SKY = { type: 'sky', zenith: [0.42, 0.47, 0.55], horizon: [0.62, 0.62, 0.62], ground: [0.2, 0.2, 0.2] };

const plastic = (name, base_color, roughness = 0.25) => ({ name, base_color, roughness, metallic: 0 });

/** One JSON entry a line: readable, and small in a diff. */
function sceneText(scene) {
  const lines = Object.entries(scene).map(([key, value]) => {
    if (!Array.isArray(value)) return `  ${JSON.stringify(key)}: ${JSON.stringify(value)}`;
    return `  ${JSON.stringify(key)}: [\n${value.map((entry) => `    ${JSON.stringify(entry)}`).join(',\n')}\n  ]`;
  });
  return `{\n${lines.join(',\n')}\n}\n`;
}

// ---------------------------------------------------------------------------------------------------- dice

const DICE = [
  // solid, face it rests on, spin, place on the ground, size, material
  ['dodecahedron', 4, 10, [-0.1, -1.35], 1.3, 'red'],
  ['cube', 0, 24, [-1.05, 0.45], 1.15, 'ivory'],
  ['octahedron', 2, 50, [0.85, 0.55], 1.1, 'teal'],
  ['icosahedron', 5, 33, [2.3, 0.35], 1.35, 'brass'],
  ['trapezohedron', 3, 100, [-2.35, -0.65], 1.05, 'slate'],
  ['tetrahedron', 1, 8, [1.65, -1.45], 0.6, 'ochre'],
  ['icosahedron', 9, 70, [-0.1, 2.15], 1.2, 'slate'],
  ['dodecahedron', 7, 61, [1.6, 2.2], 1.1, 'ivory'],
  ['cube', 2, -31, [-2.2, 1.7], 1.0, 'red'],
  ['trapezohedron', 6, 215, [-1.55, -2.15], 0.75, 'ochre'],
  ['octahedron', 5, 12, [0.85, -2.6], 0.6, 'ivory'],
];

function dice() {
  return {
    meshes: [
      ...Object.keys(SOLIDS).map((name) => ({ name, file: `solids/${name}.obj`, radius: 0.08 })),
      { name: 'ground', file: 'stage/ground.obj', rounding: false },
    ],
    materials: [
      plastic('ivory', [0.82, 0.76, 0.64]),
      plastic('red', [0.5, 0.02, 0.02], 0.2),
      plastic('teal', [0.02, 0.26, 0.27], 0.2),
      plastic('slate', [0.05, 0.06, 0.09], 0.3),
      plastic('ochre', [0.75, 0.38, 0.05], 0.25),
      { name: 'brass', base_color: [0.86, 0.62, 0.28], roughness: 0.22, metallic: 1 },
      plastic('felt', [0.2, 0.21, 0.22], 0.9),
    ],
    instances: [
      { mesh: 'ground', material: 'felt' },
      ...DICE.map(([mesh, face, spin, [x, y], size, material]) => ({
        mesh,
        material,
        matrix: matrix(
          restingOn(SOLIDS[mesh], face, spin).map((row) => scale(row, size)),
          [x, y, size / 2], // the inradius is 0.5: the face that it rests on is that far below the centre
        ),
      })),
    ],
    lights: [
      { type: 'area', center: [-4.5, -3, 7], u: [1.9, -1.4, 0], v: [0.9, 1.2, 1.5], emission: [15, 14.1, 12.8] },
      SKY,
    ],
    camera: { eye: [0.5, -9.2, 5.6], target: [0.05, -0.1, 0.3], up: [0, 0, 1], vfov_degrees: 34 },
  };
}

// -------------------------------------------------------------------------------------------------- blocks

/** A brick on the grid: lower corner at square (x, y), `level` bricks above the plate; turned: along y. */
function brickAt(mesh, material, [x, y, level], turned = false) {
  const z = PLATE_HEIGHT + level * BRICK_HEIGHT;
  if (!turned) return { mesh, material, translate: [x, y, round(z)] };
  return { mesh, material, matrix: matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [x + BRICKS[mesh][1], y, z]) };
}

/** A square tower, 8 x 8 squares outside and 2 thick, its layers in running bond; it steps down towards the viewer. */
function tower() {
  const colours = ['red', 'yellow', 'blue', 'white', 'green'];
  const bricks = [];
  for (let level = 0; level < 5; level++) {
    const material = (i) => colours[(i * 2 + level * 3) % colours.length];
    const long = level % 2 === 0;
    const layer = long
      ? [
          [[2, 2], false], [[6, 2], false], [[2, 8], false], [[6, 8], false], [[2, 4], true], [[8, 4], true],
        ]
      : [
          [[2, 2], true], [[2, 6], true], [[8, 2], true], [[8, 6], true], [[4, 2], false], [[4, 8], false],
        ];
    layer.forEach(([[x, y], turned], i) => {
      const gate = level < 2 && !turned && y === 2 && x >= 4 && x < 8;
      const steps = x + (9 - y) > 4 * (6 - level) - 3;
      if (!gate && !steps) bricks.push(brickAt('brick-2x4', material(i), [x, y, level], turned));
    });
  }
  return bricks;
}

function blocks() {
  return {
    meshes: [
      ...Object.keys(BRICKS).map((name) => ({ name, file: `bricks/${name}.obj`, radius: 0.05 })),
      { name: 'ground', file: 'stage/ground.obj', rounding: false },
    ],
    materials: [
      plastic('red', [0.6, 0.02, 0.02]),
      plastic('yellow', [0.8, 0.5, 0.02]),
      plastic('blue', [0.01, 0.1, 0.42]),
      plastic('white', [0.8, 0.8, 0.78]),
      plastic('green', [0.02, 0.28, 0.07]),
      plastic('grey', [0.3, 0.31, 0.32], 0.35),
      plastic('table', [0.36, 0.35, 0.33], 0.8),
    ],
    instances: [
      { mesh: 'ground', material: 'table' },
      { mesh: 'plate-12x12', material: 'grey' },
      ...tower(),
      brickAt('brick-2x2', 'yellow', [2, 8, 5]),
      brickAt('brick-2x2', 'white', [0, 0, 0]),
      brickAt('brick-1x2', 'blue', [0, 0, 1]),
      brickAt('brick-1x2', 'red', [10, 0, 0], true),
      brickAt('brick-1x2', 'green', [8, 0, 0]),
    ],
    lights: [
      { type: 'area', center: [-9, -16, 22], u: [6, -2.5, 0], v: [2, 4, 4], emission: [15, 14.1, 12.8] },
      SKY,
    ],
    camera: { eye: [19.5, -17, 13], target: [5.8, 5.4, 2.6], up: [0, 0, 1], vfov_degrees: 30 },
  };
}

// ---------------------------------------------------------------------------------------------------- room

const ROOM = { min: [-3, -4.5, 0], max: [3, 4.5, 4.6] };

function room() {
  const metal = { name: 'copper', base_color: [0.9, 0.5, 0.36], roughness: 0.25, metallic: 1 };
  const standing = (mesh, face, spin, [x, y, z], size, material) => ({
    mesh,
    material,
    matrix: matrix(
      restingOn(SOLIDS[mesh], face, spin).map((row) => scale(row, size)),
      [x, y, z + size / 2],
    ),
  });
  return {
    meshes: [
      { name: 'room', file: 'stage/room.obj', radius: 0.35 },
      { name: 'lamp', file: 'stage/lamp.obj', rounding: false },
      { name: 'pedestal', file: 'stage/pedestal.obj', radius: 0.08 },
      ...['cube', 'dodecahedron', 'icosahedron'].map((name) => ({ name, file: `solids/${name}.obj`, radius: 0.08 })),
    ],
    materials: [
      { name: 'light', base_color: [0, 0, 0], emission: [14, 12.5, 10.5] },
      plastic('stone', [0.6, 0.58, 0.55], 0.6),
      plastic('blue', [0.04, 0.12, 0.35], 0.2),
      plastic('ochre', [0.75, 0.42, 0.08], 0.3),
      metal,
    ],
    instances: [
      { mesh: 'room' },
      { mesh: 'lamp', material: 'light', translate: [0, 0.8, 4.35] },
      { mesh: 'pedestal', material: 'stone', translate: [-1.1, 1.9, 0] },
      standing('dodecahedron', 2, 20, [-1.1, 1.9, 1.4], 1.3, 'copper'),
      standing('cube', 0, 28, [1.15, 1.2, 0], 1.5, 'ochre'),
      standing('icosahedron', 3, 15, [0.9, -0.6, 0], 0.9, 'blue'),
    ],
    camera: { eye: [0, -4.1, 2.2], target: [0, 0.8, 1.85], up: [0, 0, 1], vfov_degrees: 60 },
  };
}

/** File name below data/ -> text. */
export function sceneFiles() {
  const walls = ['white', 'white', 'white', 'green', 'white', 'red']; // faces in the order of box()
  return {
    'dice.scene.json': sceneText(dice()),
    'blocks.scene.json': sceneText(blocks()),
    'room.scene.json': sceneText(room()),
    'stage/ground.obj': obj('the ground: its top is z = 0', [box([-500, -500, -1], [500, 500, 0])]),
    'stage/room.obj': obj('a closed room to look at from inside', [box(ROOM.min, ROOM.max)], {
      library: 'room.mtl',
      materials: walls,
    }),
    'stage/room.mtl': [
      '# Made by data/make.mjs of the Chamfer project; CC0-1.0.',
      'newmtl white\nKd 0.75 0.74 0.72\nPr 0.9',
      'newmtl red\nKd 0.55 0.06 0.05\nPr 0.9',
      'newmtl green\nKd 0.1 0.4 0.12\nPr 0.9\n',
    ].join('\n'),
    'stage/lamp.obj': obj('a flat lamp: its lower side is z = 0', [box([-0.9, -0.9, 0], [0.9, 0.9, 0.05])]),
    'stage/pedestal.obj': obj('a pedestal', [box([-0.75, -0.75, 0], [0.75, 0.75, 1.4])]),
  };
}
