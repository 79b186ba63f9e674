// The benchmark's scenes, which stand in for those of the paper: too large to be kept in the repository, the same each
// time they are made (`node data/make.mjs --bench DIR`).
import { basalt } from './bench/basalt.mjs';
import { fortress } from './bench/fortress.mjs';
import { gems } from './bench/gems.mjs';
import { temple } from './bench/temple.mjs';
import { wall } from './bench/wall.mjs';
import { box, mtl, obj, triangleCount } from './geometry.mjs';
import { sceneText } from './placing.mjs';

/** Scenes whose solids lie in one mesh, a material for each: `{solids, materials, scene}`. */
const ONE_MESH = { temple, gems, basalt, fortress };
/** Scenes of many instances: `{files: name -> [comment, solids], scene}`. */
const INSTANCED = { wall };

/** File name below the benchmark's folder -> text. */
export function benchFiles() {
  const files = { 'ground.obj': obj('the ground: its top is z = 0', [box([-500, -500, -1], [500, 500, 0])]) };
  for (const [name, make] of Object.entries(ONE_MESH)) {
    const { solids, materials, scene } = make();
    const triangles = solids.reduce((sum, solid) => sum + triangleCount(solid), 0);
    const comment = `${name}: ${solids.length} convex solids, ${triangles} triangles`;
    files[`${name}.obj`] = obj(comment, solids, { library: `${name}.mtl` });
    files[`${name}.mtl`] = mtl(materials);
    files[`${name}.scene.json`] = sceneText(scene);
  }
  for (const [name, make] of Object.entries(INSTANCED)) {
    const { files: meshes, scene } = make();
    for (const [file, [comment, solids]] of Object.entries(meshes)) files[file] = obj(comment, solids);
    files[`${name}.scene.json`] = sceneText(scene);
  }
  return files;
}
