// What README and the documents beside the sources name is there: files, folders, options of cmake, scripts that can be run.
import assert from 'node:assert/strict';
import { accessSync, constants, existsSync, readdirSync, readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { test } from 'node:test';

const SOURCE = new URL('../..', import.meta.url).pathname;
const DOCUMENTS = ['README.md', 'data/README.md', 'data/SCENES.md', 'data/COMPARISONS.md', 'server/deploy/README.md'];
const PARTS = ['common', 'preprocess', 'server', 'web', 'data', 'tests'];

const textOf = (name) => readFileSync(join(SOURCE, name), 'utf8');

/** Every file of the parts. */
const files = PARTS.flatMap(function list(folder) {
  return readdirSync(join(SOURCE, folder), { withFileTypes: true }).flatMap((entry) => {
    if (entry.name === 'node_modules' || entry.name === '__pycache__') return [];
    return entry.isDirectory() ? list(join(folder, entry.name)) : [join(folder, entry.name)];
  });
});
const fileNames = new Set(files.map((file) => basename(file)));

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

test('scripts can be run: those that begin with #! and those that documents print as commands', () => {
  const scripts = new Set(['start', 'check', '.ci/run']);
  for (const document of DOCUMENTS)
    for (const [, name] of textOf(document).matchAll(/^\s*(?:\.\/)?([\w./-]+\.(?:py|sh))\b/gm)) scripts.add(name);
  assert.ok(scripts.has('tests/bench/bench.py'), [...scripts].join());
  for (const file of files) if (/\.(py|sh)$/.test(file) && textOf(file).startsWith('#!')) scripts.add(file);
  for (const name of scripts) {
    accessSync(join(SOURCE, name), constants.X_OK);
    assert.ok(textOf(name).startsWith('#!'), name);
  }
});

test('modules use nothing that Node.js 18, that of Debian 12, does not have', () => {
  const newer = [
    /\.(with|toSorted|toReversed|toSpliced|union|intersection|difference|isSubsetOf|isWellFormed)\(/,
    /\bimport\.meta\.(dirname|filename|main)\b/,
    /\b(Promise\.(withResolvers|try)|Object\.groupBy|Map\.groupBy|Array\.fromAsync|AbortSignal\.any|Iterator\.from)\b/,
    /\b(globSync|styleText|stripTypeScriptTypes|openAsBlob)\b|'node:(sqlite|sea)'/,
    /\bimport\b.*\bwith \{ *type:|\bnew (WebSocket|EventSource)\(/,
  ];
  const modules = files.filter((file) => /\.(mjs|js)$/.test(file) && !file.endsWith('documents.test.mjs'));
  assert.ok(modules.length > 40, `${modules.length} modules`);
  for (const file of modules)
    for (const pattern of newer) assert.doesNotMatch(textOf(file), pattern, `${file}: ${pattern}`);
});
