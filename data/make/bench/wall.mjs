// A wall of 1,000,000 bricks: one brick of twelve triangles and a scene file of a few lines. A tile of 10 x 10 bricks in
// running bond, a material for each, repeats along the wall and upwards. Lengths in brick lengths.
import { box } from '../geometry.mjs';
import { plastic, round } from '../placing.mjs';
import { randomFrom } from './random.mjs';

const [LENGTH, DEPTH, HEIGHT] = [1, 0.48, 0.32];
const JOINT = 0.012; // the bricks stand on each other; sideways they are a little apart
const TILE = { bricks: 10, courses: 10 };
const REPEAT = { along: 200, up: 50 };

export function wall() {
  const random = randomFrom(1000000);
  const materials = [
    plastic('clay', [0.5, 0.19, 0.1], 0.5),
    plastic('clay-dark', [0.3, 0.1, 0.065], 0.5),
    plastic('clay-pale', [0.6, 0.3, 0.18], 0.5),
    plastic('burnt', [0.16, 0.085, 0.075], 0.4),
    plastic('earth', [0.3, 0.26, 0.2], 0.9),
  ];
  const colours = ['clay', 'clay', 'clay', 'clay', 'clay-dark', 'clay-dark', 'clay-pale', 'burnt'];
  const instances = [];
  for (let course = 0; course < TILE.courses; course++) {
    for (let i = 0; i < TILE.bricks; i++) {
      instances.push({
        mesh: 'brick',
        material: random.among(colours),
        translate: [round(i + (course % 2) / 2), 0, round(course * HEIGHT)],
        repeat: [
          { count: REPEAT.along, step: [TILE.bricks * LENGTH, 0, 0] },
          { count: REPEAT.up, step: [0, 0, round(TILE.courses * HEIGHT)] },
        ],
      });
    }
  }
  return {
    files: { 'brick.obj': ['a brick', [box([0, 0, 0], [LENGTH - JOINT, DEPTH, HEIGHT])]] },
    scene: {
      meshes: [
        { name: 'brick', file: 'brick.obj', radius: 0.03 },
        { name: 'ground', file: 'ground.obj', rounding: false },
      ],
      materials,
      instances: [{ mesh: 'ground', material: 'earth', scale: [10, 10, 1] }, ...instances],
      lights: [
        { type: 'directional', direction: [0.7, 0.5, -0.6], irradiance: [3, 2.7, 2.2], angular_diameter_degrees: 2 },
        { type: 'sky', zenith: [0.16, 0.25, 0.45], horizon: [0.45, 0.48, 0.5], ground: [0.2, 0.18, 0.15] },
      ],
      camera: { eye: [10, -7, 2.2], target: [26, 0, 5], up: [0, 0, 1], vfov_degrees: 50 },
    },
  };
}
