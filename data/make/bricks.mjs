// Building blocks: a box with one prism (a stud) per unit square on top, every one a closed convex solid of its own.
// Units: one stud pitch. A brick's box starts at the origin; stacked on a grid, boxes touch face to face, and a stud
// stands inside the box above it.
import { box, obj, prism } from './geometry.mjs';

export const BRICK_HEIGHT = 1.2;
export const PLATE_HEIGHT = 0.4;
const STUD = { sides: 24, radius: 0.3, height: 0.2 };

/** name -> [squares along x, squares along y, height] */
export const BRICKS = {
  'brick-1x2': [2, 1, BRICK_HEIGHT],
  'brick-2x2': [2, 2, BRICK_HEIGHT],
  'brick-2x4': [4, 2, BRICK_HEIGHT],
  'plate-12x12': [12, 12, PLATE_HEIGHT],
};

function brick([nx, ny, height]) {
  const solids = [{ name: 'box', ...box([0, 0, 0], [nx, ny, height]) }];
  for (let y = 0; y < ny; y++) {
    for (let x = 0; x < nx; x++) {
      const stud = prism(STUD.sides, STUD.radius, [x + 0.5, y + 0.5], height, height + STUD.height);
      solids.push({ name: `stud_${x}_${y}`, ...stud });
    }
  }
  return solids;
}

/** File name below data/ -> text. */
export function brickFiles() {
  return Object.fromEntries(
    Object.entries(BRICKS).map(([name, size]) => {
      const comment = `${name}: a box and ${size[0] * size[1]} studs that touch it, each a closed convex solid`;
      return [`bricks/${name}.obj`, obj(comment, brick(size))];
    }),
  );
}
