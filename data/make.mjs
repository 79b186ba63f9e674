// Makes every mesh and scene in this folder: `node data/make.mjs` writes them, `node data/make.mjs --check` only compares
// what lies here with what would be written (exit status 1 names the first difference). No dependency, no randomness.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { brickFiles } from './make/bricks.mjs';
import { sceneFiles } from './make/scenes.mjs';
import { solidFiles } from './make/solids.mjs';

const folder = dirname(fileURLToPath(import.meta.url));
const checkOnly = process.argv.includes('--check');
const files = { ...solidFiles(), ...brickFiles(), ...sceneFiles() };

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
