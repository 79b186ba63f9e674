// The README's curl examples on the real server, as printed:
//   node tests/browser/readme.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER --readme FILE
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parseArgs, promisify } from 'node:util';

import { makeRoot, startServer } from '../support/server.mjs';

const PRINTED_ADDRESS = 'http://127.0.0.1:8080';

const { values: paths } = parseArgs({
  options: {
    chamferd: { type: 'string' },
    chamferprep: { type: 'string' },
    data: { type: 'string' },
    readme: { type: 'string' },
  },
});

let root;
let server;
let folder;

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data);
  folder = mkdtempSync(join(tmpdir(), 'chamfer-readme-'));
  server = await startServer(paths.chamferd, root.root, 0, ['--jobs', join(folder, 'jobs')]);
});

after(async () => {
  await server?.stop();
  root?.remove();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/** The examples in the README's only sh block: each the text between two blank lines. */
function examples() {
  const blocks = [...readFileSync(paths.readme, 'utf8').matchAll(/```sh\n([^`]*)```/g)];
  assert.equal(blocks.length, 1);
  return blocks[0][1].trim().split(/\n\n+/);
}

test('every example ends well and does what it says', async () => {
  const outputs = [];
  for (const example of examples()) {
    assert.ok(example.includes(PRINTED_ADDRESS), example);
    const script = `set -eu -o pipefail\n${example.replaceAll(PRINTED_ADDRESS, server.url)}`;
    const { stdout } = await promisify(execFile)('bash', ['-c', script], { cwd: folder, timeout: 60_000 });
    outputs.push(stdout);
  }
  const all = outputs.join('\n');
  assert.match(all, /^blocks {2}\d+ triangles, radius below 0\.\d+$/m);
  assert.match(all, /"feature": "cylinder"/);
  assert.match(all, /"parameters":/);
  assert.match(all, /^sharp differs: /m);
  assert.match(all, /^\/v1\/openapi\.json$/m);
  assert.match(all, /^chamfer_rays_total\{kind="camera"\} [1-9]/m);
  assert.equal(readFileSync(join(folder, 'blocks.glb')).subarray(0, 4).toString('latin1'), 'glTF');

  const size = (name) => {
    const bytes = readFileSync(join(folder, name));
    assert.equal(bytes.subarray(1, 4).toString('latin1'), 'PNG', name);
    return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
  };
  assert.deepEqual(size('blocks.png'), [640, 480]);
  assert.deepEqual(size('tile.png'), [256, 256]);
  assert.notDeepEqual(readFileSync(join(folder, 'tile.png')), readFileSync(join(folder, 'sharp.png')));
});
