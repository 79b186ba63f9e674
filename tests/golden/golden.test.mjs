// The bundled scenes against what they were, their tiles against their frames, the exact rounding against
// explicit meshes: by `chamferd compare --suite`, as a build farm would do it; and that it sees what is wrong.
// After an intended change of the pictures: chamferd compare --suite tests/golden/scenes.cases.json --root data --update
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { parseArgs } from 'node:util';

const { values } = parseArgs({ options: { chamferd: { type: 'string' }, data: { type: 'string' }, suites: { type: 'string' }, output: { type: 'string' } } });

function compare(name) {
  const run = spawnSync(values.chamferd, ['compare', '--suite', `${values.suites}/${name}.cases.json`, '--root', values.data,
    '--json', '-', '--junit', `${values.output}/${name}.xml`, '--html', `${values.output}/${name}.html`], { encoding: 'utf8', maxBuffer: 1 << 28 });
  assert.equal(run.stderr, '');
  return { status: run.status, result: JSON.parse(run.stdout) };
}

test('the bundled scenes are as they were, and as their meshes', () => {
  const { status, result } = compare('scenes');
  for (const one of result.cases) assert.equal(one.outcome, 'same', `${one.name}: ${one.reason}\n${one.command}`);
  assert.equal(status, 0);
});

test('what is wrong is seen', () => {
  const { status, result } = compare('wrong');
  for (const one of result.cases) assert.equal(one.outcome, 'differs', `${one.name}: ${one.reason}\n${one.command}`);
  assert.equal(status, 1);
});
