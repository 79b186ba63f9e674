// Small vector algebra and polyhedra for the generators. Points are [x, y, z]; a polyhedron is {vertices, faces} with
// faces as lists of vertex indices, counter-clockwise seen from outside. The frame is right-handed with z up.

export const add = (a, b) => a.map((x, i) => x + b[i]);
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const scale = (a, s) => a.map((x) => x * s);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => scale(a, 1 / Math.hypot(...a));

/** Convex hull with its coplanar points merged into polygons. Tries all planes through three points: for few points only. */
export function hull(vertices) {
  const count = vertices.length;
  const centre = scale(vertices.reduce(add), 1 / count);
  const tolerance = 1e-9 * Math.max(...vertices.map((v) => Math.hypot(...sub(v, centre))));
  const faces = new Map();
  for (let i = 0; i < count; i++) {
    for (let j = 0; j < count; j++) {
      for (let k = 0; k < count; k++) {
        if (i === j || j === k || i === k) continue;
        const normal = cross(sub(vertices[j], vertices[i]), sub(vertices[k], vertices[i]));
        if (Math.hypot(...normal) < tolerance) continue;
        const n = unit(normal);
        const heights = vertices.map((v) => dot(n, sub(v, vertices[i])));
        if (heights.some((h) => h > tolerance)) continue;
        const face = [...heights.keys()].filter((v) => heights[v] > -tolerance);
        faces.set(face.join(), sortAround(face, vertices, n));
      }
    }
  }
  return { vertices, faces: [...faces.values()] };
}

function sortAround(face, vertices, normal) {
  const centre = scale(face.map((v) => vertices[v]).reduce(add), 1 / face.length);
  const x = unit(sub(vertices[face[0]], centre));
  const y = cross(normal, x);
  const angle = (v) => Math.atan2(dot(sub(vertices[v], centre), y), dot(sub(vertices[v], centre), x));
  return [...face].sort((a, b) => angle(a) - angle(b));
}

export function faceNormal({ vertices, faces }, index) {
  const [a, b, c] = faces[index].map((v) => vertices[v]);
  return unit(cross(sub(b, a), sub(c, a)));
}

/** The same solid about the origin with inradius 0.5: its largest inscribed ball, about the origin, has diameter 1. */
export function withUnitInsphere(solid) {
  const inradius = Math.min(...solid.faces.map((face, i) => dot(faceNormal(solid, i), solid.vertices[face[0]])));
  return { ...solid, vertices: solid.vertices.map((v) => scale(v, 0.5 / inradius)) };
}

/** Axis-parallel box between two corners. Faces: bottom, top, front (-y), right (+x), back (+y), left (-x). */
export function box([x0, y0, z0], [x1, y1, z1]) {
  const vertices = [
    [x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0],
    [x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1],
  ];
  const faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
  return { vertices, faces };
}

/** Upright convex solid between two polygons of equally many corners, [x, y] each, counter-clockwise seen from above; its
 * sides are plane where matching edges are parallel. The heights may be functions of (x, y), affine ones for plane caps. */
export function loft(lower, upper, z0, z1) {
  const at = (z, [x, y]) => [x, y, typeof z === 'function' ? z(x, y) : z];
  const sides = lower.length;
  const corners = [...lower.keys()];
  const walls = corners.map((k) => [k, (k + 1) % sides, sides + ((k + 1) % sides), sides + k]);
  return {
    vertices: [...lower.map((p) => at(z0, p)), ...upper.map((p) => at(z1, p))],
    faces: [corners.slice().reverse(), corners.map((k) => sides + k), ...walls],
  };
}

/** Regular polygon with `sides` corners on a circle of `radius` about (x, y). */
export const ring = (sides, radius, [x, y]) =>
  Array.from({ length: sides }, (_, k) => {
    const angle = (2 * Math.PI * (k + 0.5)) / sides;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });

/** Upright frustum over regular polygons about (x, y), with the circumscribed radii r0 below and r1 above. */
export const frustum = (sides, r0, r1, at, z0, z1) => loft(ring(sides, r0, at), ring(sides, r1, at), z0, z1);

/** Upright prism over a regular polygon with `sides` corners on a circle of `radius` about (x, y). */
export const prism = (sides, radius, at, z0, z1) => frustum(sides, radius, radius, at, z0, z1);

/** The solid after x -> rows x + t; `rows` a 3x3 matrix of positive determinant. */
export const placed = ({ vertices, faces }, rows, t) => ({
  vertices: vertices.map((v) => rows.map((row, i) => dot(row, v) + t[i])),
  faces,
});

/** Triangles of a polyhedron once its polygons are cut into fans, as every reader cuts them. */
export const triangleCount = ({ faces }) => faces.reduce((sum, face) => sum + face.length - 2, 0);

const number = (x) => String(Object.is(x, -0) || Math.abs(x) < 5e-10 ? 0 : Number(x.toFixed(9)));

/** OBJ text of one or several solids, each an object with vertices of its own. Materials are named one per face
 * (`materials`) or one per solid (its `material`). */
export function obj(comment, solids, { library, materials } = {}) {
  const lines = [`# ${comment}`, '# Made by data/make.mjs of the Chamfer project; CC0-1.0.'];
  if (library) lines.push(`mtllib ${library}`);
  let first = 1;
  let current;
  for (const { name, material, vertices, faces } of solids) {
    if (name) lines.push(`o ${name}`);
    if (material && material !== current) lines.push(`usemtl ${(current = material)}`);
    for (const v of vertices) lines.push(`v ${v.map(number).join(' ')}`);
    faces.forEach((face, i) => {
      if (materials && materials[i] !== materials[i - 1]) lines.push(`usemtl ${materials[i]}`);
      lines.push(`f ${face.map((v) => v + first).join(' ')}`);
    });
    first += vertices.length;
  }
  return `${lines.join('\n')}\n`;
}

/** MTL text of materials named as in scene files: {name, base_color, roughness, metallic, transmission, ior}. */
export function mtl(materials) {
  const entries = materials.map(({ name, base_color, roughness, metallic, transmission, ior }) => {
    const lines = [`newmtl ${name}`, `Kd ${base_color.join(' ')}`, `Pr ${roughness}`];
    if (metallic) lines.push(`Pm ${metallic}`);
    if (transmission) lines.push(`d ${number(1 - transmission)}`);
    if (ior) lines.push(`Ni ${ior}`);
    return `${lines.join('\n')}\n`;
  });
  return ['# Made by data/make.mjs of the Chamfer project; CC0-1.0.\n', ...entries].join('');
}
