// Placing solids, and the words that scene files share. Frame: z up, right-handed; angles in degrees.
import { cross, dot, faceNormal, unit } from './geometry.mjs';

export const round = (x) => Number(x.toFixed(9)) + 0;

/** 4x4 row-major, from a 3x3 matrix (rows) and a translation. */
export const matrix = (rows, t) => [...rows.flatMap((row, i) => [...row, t[i]]), 0, 0, 0, 1].map(round);

export function rotationAbout(axis, degrees) {
  const [x, y, z] = unit(axis);
  const c = Math.cos((degrees * Math.PI) / 180);
  const s = Math.sin((degrees * Math.PI) / 180);
  return [
    [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
    [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
    [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
  ];
}

export const times = (a, b) => a.map((row) => [0, 1, 2].map((j) => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]));

/** Rotation that lays face `index` of a solid on the ground, then spins it about z. */
export function restingOn(solid, index, spinDegrees) {
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
export const EVEN_SKY = { type: 'sky', zenith: [0.42, 0.47, 0.55], horizon: [0.62, 0.62, 0.62], ground: [0.2, 0.2, 0.2] };

export const plastic = (name, base_color, roughness = 0.25) => ({ name, base_color, roughness, metallic: 0 });

/** One JSON entry a line: readable, and small in a diff. */
export function sceneText(scene) {
  const lines = Object.entries(scene).map(([key, value]) => {
    if (!Array.isArray(value)) return `  ${JSON.stringify(key)}: ${JSON.stringify(value)}`;
    return `  ${JSON.stringify(key)}: [\n${value.map((entry) => `    ${JSON.stringify(entry)}`).join(',\n')}\n  ]`;
  });
  return `{\n${lines.join(',\n')}\n}\n`;
}
