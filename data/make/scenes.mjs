// The scene files, and the few meshes that only scenes use. Frame: z up, right-handed; angles in degrees.
import { BRICK_HEIGHT, BRICKS, PLATE_HEIGHT } from './bricks.mjs';
import { box, hull, obj, ring, scale } from './geometry.mjs';
import { EVEN_SKY, matrix, plastic, restingOn, round, sceneText } from './placing.mjs';
import { SOLIDS } from './solids.mjs';

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
      EVEN_SKY,
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
      EVEN_SKY,
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
      { name: 'pedestal', file: 'stage/pedestal.obj', radius: 0.08 },
      ...['cube', 'dodecahedron', 'icosahedron'].map((name) => ({ name, file: `solids/${name}.obj`, radius: 0.08 })),
    ],
    materials: [
      plastic('stone', [0.6, 0.58, 0.55], 0.6),
      plastic('blue', [0.04, 0.12, 0.35], 0.2),
      plastic('ochre', [0.75, 0.42, 0.08], 0.3),
      metal,
    ],
    instances: [
      { mesh: 'room' },
      { mesh: 'pedestal', material: 'stone', translate: [-1.1, 1.9, 0] },
      standing('dodecahedron', 2, 20, [-1.1, 1.9, 1.4], 1.3, 'copper'),
      standing('cube', 0, 28, [1.15, 1.2, 0], 1.5, 'ochre'),
      standing('icosahedron', 3, 15, [0.9, -0.6, 0], 0.9, 'blue'),
    ],
    // A quad that leaves no room for light above it: the ceiling there would glow and show as noise. Nothing shines outside.
    lights: [
      { type: 'area', center: [0, 0.8, 4.598], u: [0.9, 0, 0], v: [0, 0.9, 0], emission: [14, 12.5, 10.5] },
      { type: 'environment', color: 0 },
    ],
    camera: { eye: [0, -4.1, 2.2], target: [0, 0.8, 1.85], up: [0, 0, 1], vfov_degrees: 60 },
  };
}

// ---------------------------------------------------------------------------------------------- still life

const BOARD = { half: [2.6, 1.7], high: 0.22 };
/** A six-sided crystal, pointed above, standing on the origin. */
const CRYSTAL = hull([...ring(6, 0.42, [0, 0]).flatMap(([x, y]) => [[x, y, 0], [x, y, 1.45]]), [0, 0, 2.05]]);

const STILL_LIFE = [
  // solid, face it rests on, spin, place on the board, height of what it stands on, size, material
  ['dodecahedron', 4, 14, [-0.95, 0.25], 0, 1.25, 'glass'],
  ['cube', 0, 31, [0.95, 0.55], 0, 1.0, 'bottle'],
  ['octahedron', 3, 70, [0.15, -0.75], 0, 0.62, 'amber'],
  ['cube', 1, 18, [1.75, -0.55], 0, 0.46, 'ivory'],
  ['cube', 2, 52, [1.75, -0.55], 0.46, 0.4, 'red'],
  ['cube', 4, -14, [-0.45, -1.25], 0, 0.38, 'ivory'],
  ['icosahedron', 2, 25, [-1.55, -1.0], 0, 0.6, 'brass'],
  ['trapezohedron', 3, 205, [0.85, -1.25], 0, 0.42, 'slate'],
  ['tetrahedron', 1, 20, [2.05, 1.0], 0, 0.34, 'red'],
  ['dodecahedron', 6, 51, [-2.1, 0.35], 0, 0.5, 'slate'],
  ['trapezohedron', 5, 80, [-2.0, 1.2], 0, 0.44, 'ivory'],
];

function stillLife() {
  const clear = (name, base_color, ior) => ({ name, base_color, roughness: 0, metallic: 0, transmission: 1, ior });
  return {
    meshes: [
      ...Object.keys(SOLIDS).map((name) => ({ name, file: `solids/${name}.obj`, radius: 0.06 })),
      { name: 'crystal', file: 'stage/crystal.obj', radius: 0.03 },
      { name: 'board', file: 'stage/board.obj', radius: 0.05 },
      { name: 'ground', file: 'stage/ground.obj', rounding: false },
    ],
    materials: [
      clear('glass', [1, 1, 1], 1.52),
      { ...clear('bottle', [1, 1, 1], 1.52), absorption: [1.9, 0.28, 1.1] },
      { ...clear('amber', [1, 1, 1], 1.55), absorption: [0.25, 1.6, 5] },
      { ...clear('frosted', [1, 1, 1], 1.5), roughness: 0.22 },
      plastic('ivory', [0.82, 0.76, 0.64]),
      plastic('red', [0.5, 0.02, 0.02], 0.2),
      plastic('slate', [0.05, 0.06, 0.09], 0.3),
      { name: 'brass', base_color: [0.86, 0.62, 0.28], roughness: 0.22, metallic: 1 },
      plastic('walnut', [0.22, 0.115, 0.055], 0.4),
      plastic('linen', [0.48, 0.46, 0.43], 0.9),
    ],
    instances: [
      { mesh: 'ground', material: 'linen' },
      { mesh: 'board', material: 'walnut' },
      { mesh: 'crystal', material: 'frosted', translate: [0.1, 0.95, BOARD.high] },
      ...STILL_LIFE.map(([mesh, face, spin, [x, y], above, size, material]) => ({
        mesh,
        material,
        matrix: matrix(
          restingOn(SOLIDS[mesh], face, spin).map((row) => scale(row, size)),
          [x, y, BOARD.high + above + size / 2],
        ),
      })),
    ],
    lights: [
      { type: 'area', center: [-4.6, 2.6, 5.2], u: [1.2, 1.6, 0], v: [1.1, -0.8, 1.3], emission: [13, 12.2, 11] },
      { type: 'area', center: [5.2, -3.5, 3.6], u: [0.5, 0.8, 0], v: [-0.3, 0.2, 1.4], emission: [3.2, 3.6, 4.2] },
      { type: 'sky', zenith: [0.3, 0.33, 0.38], horizon: [0.42, 0.42, 0.43], ground: [0.2, 0.2, 0.2] },
    ],
    camera: { eye: [0.6, -7.4, 3.6], target: [0.0, 0.1, 0.55], up: [0, 0, 1], vfov_degrees: 30 },
  };
}

/** File name below data/ -> text. */
export function sceneFiles() {
  const walls = ['white', 'white', 'white', 'green', 'white', 'red']; // faces in the order of box()
  return {
    'dice.scene.json': sceneText(dice()),
    'blocks.scene.json': sceneText(blocks()),
    'room.scene.json': sceneText(room()),
    'still-life.scene.json': sceneText(stillLife()),
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
    'stage/board.obj': obj('a board on the ground', [
      box([-BOARD.half[0], -BOARD.half[1], 0], [...BOARD.half, BOARD.high]),
    ]),
    'stage/crystal.obj': obj('a pointed crystal that stands on the origin', [CRYSTAL]),
    'stage/pedestal.obj': obj('a pedestal', [box([-0.75, -0.75, 0], [0.75, 0.75, 1.4])]),
  };
}
