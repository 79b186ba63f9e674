// ./start and what it shares with ./check, with programs that only tell how they were called in place of the real ones.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { chmodSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

const SOURCE = new URL('../..', import.meta.url).pathname;
const HASWELL = 'flags\t\t: fpu sse2 fma movbe avx f16c abm bmi1 avx2 bmi2\n';

let folder;

const write = (name, text, mode = 0o644) => {
  const file = join(folder, name);
  mkdirSync(join(file, '..'), { recursive: true });
  writeFileSync(file, text);
  chmodSync(file, mode);
  return file;
};

/** A copy of the scripts beside a build whose programs only print; cmake does nothing. */
before(() => {
  folder = mkdtempSync(join(tmpdir(), 'chamfer-scripts-'));
  cpSync(join(SOURCE, 'start'), join(folder, 'start'));
  cpSync(join(SOURCE, '.ci'), join(folder, '.ci'), { recursive: true });
  write('programs/cmake', '#!/bin/sh\necho "cmake $*"\nexit ${CMAKE_STATUS:-0}\n', 0o755);
  write('programs/dpkg-query', '#!/bin/sh\nprintf installed\n', 0o755);
  write('build/release/preprocess/chamferprep', '#!/bin/sh\n', 0o755);
  write(
    'build/release/server/chamferd',
    '#!/bin/sh\necho "chamferd $* host=$CHAMFER_HOST port=$CHAMFER_PORT"\n',
    0o755,
  );
});

after(() => rmSync(folder, { recursive: true, force: true }));

function run(command, args, environment = {}) {
  const clean = Object.fromEntries(
    Object.entries(process.env).filter(([name]) => !/^(HOST|PORT|CHAMFER_.*)$/.test(name)),
  );
  const env = { ...clean, PATH: `${folder}/programs:${process.env.PATH}`, ...environment };
  return spawnSync(command, args, { cwd: folder, env, encoding: 'utf8' });
}
const start = (args, environment) => run(join(folder, 'start'), args, environment);
const shell = (script) => run('bash', ['-euo', 'pipefail', '-c', `source .ci/machine.sh; source .ci/packages.sh; ${script}`]);

test('start hands its arguments and the address on to chamferd', () => {
  const plain = start([]);
  assert.equal(plain.status, 0, plain.stderr);
  assert.match(plain.stdout, /^chamferd serve data host=127\.0\.0\.1 port=8080$/m);
  const given = start(['--port', '9000', '--up-axis', 'y'], { PORT: '8081' });
  assert.match(given.stdout, /^chamferd serve data --port 9000 --up-axis y host=127\.0\.0\.1 port=8081$/m);
  const mirrored = start([], { CHAMFER_PORT: '8082' });
  assert.match(mirrored.stdout, /port=8082$/m);
});

test('an address beyond this machine needs keys or --no-auth, and says so before the build', () => {
  const refused = [
    start([], { HOST: '0.0.0.0' }),
    start(['--host', '::'], {}),
    start(['--host=192.0.2.1'], {}),
    start([], { CHAMFER_HOST: '0.0.0.0' }),
  ];
  for (const { status, stdout, stderr } of refused) {
    assert.equal(status, 2);
    assert.match(stderr, /--key-file FILE.*--no-auth/s);
    assert.doesNotMatch(stdout, /cmake/);
  }
  const accepted = [
    start(['--no-auth'], { HOST: '0.0.0.0' }),
    start(['--key-file', 'keys'], { HOST: '0.0.0.0' }),
    start(['--key-file=keys', '--host', '::']),
    start([], { HOST: '0.0.0.0', CHAMFER_KEY_FILE: 'keys' }),
    start(['--host', 'localhost']),
  ];
  for (const { status, stdout, stderr } of accepted) {
    assert.equal(status, 0, stderr);
    assert.match(stdout, /^chamferd serve data/m);
  }
});

test('a processor without AVX2 is named', () => {
  const processor = (name, flags) => shell(`check_processor ${write(name, `processor\t: 0\n${flags}${flags}`)}`);
  assert.equal(processor('haswell', HASWELL).status, 0);
  const old = processor('ivy-bridge', HASWELL.replace(' avx2', ''));
  assert.equal(old.status, 1);
  assert.match(old.stderr, /^error: this processor lacks avx2\. Chamfer needs an x86-64 processor with AVX2/);
  const arm = processor('arm', 'Features\t: fp asimd\n');
  assert.equal(arm.status, 1);
  assert.match(arm.stderr, /lacks avx2 fma/);
});

test('other systems are told what to do, when something fails', () => {
  const bookworm = write('bookworm', 'ID=debian\nVERSION_ID="12"\n');
  const trixie = write('trixie', 'ID=debian\nVERSION_ID="13"\n');
  const fedora = write('fedora', 'ID=fedora\nVERSION_ID=40\n');
  assert.equal(shell(`is_debian_12 ${bookworm}`).status, 0);
  for (const other of [trixie, fedora, join(folder, 'nowhere')])
    assert.equal(shell(`is_debian_12 ${other}`).status, 1, other);

  const script = (status) => `is_debian_12() { return 1; }; install_packages .ci/packages.txt; exit ${status}`;
  const failed = shell(script(3));
  assert.equal(failed.status, 3);
  assert.match(failed.stderr, /docker run .* debian:12/);
  assert.match(failed.stderr, /\.ci\/packages\.txt/);
  assert.equal(shell(script(0)).stderr, '');
});

test('packages are installed up to the part that is asked for, and only those that are missing', () => {
  write('programs/dpkg-query', '#!/bin/sh\nfor name; do :; done\n[ "$name" = cmake ] || printf installed\n', 0o755);
  const list = write('list', 'cmake\nninja-build\nabsent-thing: sh\n\n# tests: more\nlibgtest-dev\n');
  assert.equal(shell(`missing_packages ${list}`).stdout, 'cmake\n');
  write('programs/dpkg-query', '#!/bin/sh\n', 0o755);
  assert.equal(shell(`missing_packages ${list}`).stdout, 'cmake\nninja-build\n');
  assert.equal(shell(`missing_packages ${list} tests`).stdout, 'cmake\nninja-build\nlibgtest-dev\n');
  write('programs/dpkg-query', '#!/bin/sh\nprintf installed\n', 0o755);
});

test('check looks at the processor before it builds', () => {
  const check = readFileSync(join(SOURCE, 'check'), 'utf8');
  const places = ['check_processor', 'install_packages', 'cmake --preset'].map((word) => check.indexOf(word));
  assert.ok(places[0] > 0 && places[0] < places[1] && places[1] < places[2]);
});
