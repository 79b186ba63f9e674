// What README and the documents beside the sources name is there: files, folders, options of cmake, scripts that can be run.
import assert from 'node:assert/strict';
import { accessSync, constants, existsSync, readdirSync, readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { test } from 'node:test';

const SOURCE = new URL('../..', import.meta.url).pathname;
const DOCUMENTS = ['README.md', 'data/README.md', 'data/SCENES.md', 'server/deploy/README.md'];
const PARTS = ['common', 'preprocess', 'server', 'web', 'data', 'tests'];

const textOf = (name) => readFileSync(join(SOURCE, name), 'utf8');

/** Names of the source files of the parts, without their folders. */
const fileNames = new Set(
  PARTS.flatMap(function list(folder) {
    return readdirSync(join(SOURCE, folder), { withFileTypes: true }).flatMap((entry) =>
      entry.name === 'node_modules' ? [] : entry.isDirectory() ? list(join(folder, entry.name)) : [entry.name],
    );
  }),
);

test('paths that documents name exist', () => {
  let count = 0;
  for (const document of DOCUMENTS) {
    for (const [, name] of textOf(document).matchAll(/`((?:common|preprocess|server|web|data|tests)\/[\w./-]*)`/g)) {
      assert.ok(existsSync(join(SOURCE, name)), `${document}: ${name}`);
      count += 1;
    }
    for (const [, name] of textOf(document).matchAll(/\]\((?!https?:)([^)#]+)\)/g)) {
      assert.ok(existsSync(join(SOURCE, dirname(document), name)), `${document}: ${name}`);
      count += 1;
    }
  }
  assert.ok(count > 20, `${count} names`);
});

test('source files that README names by their last part exist', () => {
  const names = [...textOf('README.md').matchAll(/`(?:[\w/]+\/)?(\w+\.(?:cpp|h|js|mjs|py))`/g)].map(([, name]) => name);
  assert.ok(names.length > 10, `${names.length} names`);
  for (const name of names) assert.ok(fileNames.has(name), name);
});

test('folders that README lists are those of the tree', () => {
  const listed = [...textOf('README.md').matchAll(/^\| `([\w/]+)\/` \|(.*)\|$/gm)];
  assert.deepEqual([...new Set(listed.map(([, name]) => name.split('/')[0]))].sort(), [...PARTS].sort());
  for (const [, folder, about] of listed) {
    // A row whose folder has parts names each of them.
    if (!folder.startsWith('server/') && folder !== 'preprocess') continue;
    const parts = readdirSync(join(SOURCE, folder), { withFileTypes: true }).filter((entry) => entry.isDirectory());
    for (const { name } of parts) assert.ok(about.includes(`\`${name}\``), `${folder}/${name} is not told of`);
    for (const [, name] of about.matchAll(/`(\w+)`/g))
      assert.ok(parts.some((part) => part.name === name) || name === 'chamferprep' || name === 'chamferd', name);
  }
});

test('scripts that begin with #! and commands that documents print can be run', () => {
  const scripts = new Set(['start', 'check', '.ci/run']);
  for (const document of DOCUMENTS)
    for (const [, name] of textOf(document).matchAll(/^\s*(?:\.\/)?([\w./-]+\.(?:py|sh))\b/gm)) scripts.add(name);
  assert.ok(scripts.has('tests/bench/bench.py'), [...scripts].join());
  for (const name of scripts) {
    accessSync(join(SOURCE, name), constants.X_OK);
    assert.ok(textOf(name).startsWith('#!'), basename(name));
  }
});
