// Dice-like solids about the origin, each with inradius 0.5 (so each takes any radius below 0.5): the five Platonic
// solids and the pentagonal trapezohedron, the ten-sided die.
import { hull, obj, withUnitInsphere } from './geometry.mjs';

const golden = (1 + Math.sqrt(5)) / 2;
const signs = [-1, 1];
const cyclic = ([x, y, z]) => [[x, y, z], [z, x, y], [y, z, x]];

function trapezohedron() {
  // The ring zigzags by +-c; the apex height follows from the kites being plane.
  const c = 0.1;
  const cos36 = Math.cos(Math.PI / 5);
  const apex = (c * (1 + cos36)) / (1 - cos36);
  const ring = Array.from({ length: 10 }, (_, k) => {
    const angle = (Math.PI * k) / 5;
    return [Math.cos(angle), Math.sin(angle), k % 2 === 0 ? c : -c];
  });
  return [[0, 0, apex], [0, 0, -apex], ...ring];
}

const VERTICES = {
  tetrahedron: [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
  cube: signs.flatMap((x) => signs.flatMap((y) => signs.map((z) => [x, y, z]))),
  octahedron: signs.flatMap((s) => cyclic([s, 0, 0])),
  dodecahedron: signs.flatMap((a) =>
    signs.flatMap((b) => [...signs.map((c) => [a, b, c]), ...cyclic([0, a / golden, b * golden])]),
  ),
  icosahedron: signs.flatMap((a) => signs.flatMap((b) => cyclic([0, a, b * golden]))),
  trapezohedron: trapezohedron(),
};

/** Every solid by name, as {vertices, faces}. */
export const SOLIDS = Object.fromEntries(
  Object.entries(VERTICES).map(([name, vertices]) => [name, withUnitInsphere(hull(vertices))]),
);

/** File name below data/ -> text. */
export function solidFiles() {
  return Object.fromEntries(
    Object.entries(SOLIDS).map(([name, solid]) => {
      const comment = `${name}: ${solid.faces.length} faces, centred at the origin, inradius 0.5`;
      return [`solids/${name}.obj`, obj(comment, [solid])];
    }),
  );
}
