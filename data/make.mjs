// Makes every mesh and scene in this folder: `node data/make.mjs` writes them, `node data/make.mjs --check` only compares
// what lies here with what would be written (exit status 1 names the first difference). `node data/make.mjs --bench DIR`
// writes the benchmark's large scenes to a folder of your own. No dependency; the same bytes each time.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { benchFiles } from './make/bench.mjs';
import { brickFiles } from './make/bricks.mjs';
import { sceneFiles } from './make/scenes.mjs';
import { solidFiles } from './make/solids.mjs';

const [option, benchFolder] = process.argv.slice(2);
const known = option === undefined || option === '--check' || (option === '--bench' && benchFolder);
if (!known) {
  console.error('usage: node data/make.mjs [--check | --bench DIR]');
  process.exit(2);
}
const checkOnly = option === '--check';
const folder = option === '--bench' ? benchFolder : dirname(fileURLToPath(import.meta.url));
const files = option === '--bench' ? benchFiles() : { ...solidFiles(), ...brickFiles(), ...sceneFiles() };

const stale = [];
for (const [name, text] of Object.entries(files)) {
  const path = join(folder, name);
  if (existsSync(path) && readFileSync(path, 'utf8') === text) continue;
  stale.push(name);
  if (checkOnly) continue;
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, text);
}

if (checkOnly && stale.length > 0) {
  console.error(`data/${stale[0]} is not what data/make.mjs makes (${stale.length} such files); run: node data/make.mjs`);
  process.exit(1);
}
console.log(`${Object.keys(files).length} files, ${stale.length} ${checkOnly ? 'differ' : 'written'}`);
