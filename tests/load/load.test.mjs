// One server under load, abuse and for long: each part ends with the server alive and a right tile.
//   node tests/load/load.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER [--quick] [--seed N] [--only WORD] [--instrumented]
// --quick takes about half a minute (./check runs it), without it minutes. Figures are printed as diagnostics, a line of
// JSON a part. --only runs the parts whose name contains WORD. --instrumented: the server keeps what it has freed, as
// sanitizers do, and its memory says nothing.
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { parseArgs } from 'node:util';

import { makeRoot } from '../support/server.mjs';
import { cancels } from './cancels.mjs';
import { overload } from './overload.mjs';
import { rate } from './rate.mjs';
import { slowClients } from './slow_clients.mjs';
import { soak } from './soak.mjs';

const { values: given } = parseArgs({
  options: {
    chamferd: { type: 'string' },
    chamferprep: { type: 'string' },
    data: { type: 'string' },
    quick: { type: 'boolean', default: false },
    seed: { type: 'string', default: '1' },
    only: { type: 'string', default: '' },
    instrumented: { type: 'boolean', default: false },
  },
});

let root;

before(() => {
  root = makeRoot(given.chamferprep, given.data, ['blocks.scene.json']);
});

after(() => root?.remove());

/** Load of the machine, without which times say little. */
function machineLoad() {
  return Number(readFileSync('/proc/loadavg', 'utf8').split(' ')[0]);
}

for (const [name, part] of Object.entries({ slowClients, cancels, overload, rate, soak })) {
  test(name, { skip: !name.includes(given.only) }, async (t) => {
    const load = machineLoad();
    const figures = await part({ ...given, root: root.root, seed: Number(given.seed) });
    t.diagnostic(`${name} ${JSON.stringify({ ...figures, machineLoad: [load, machineLoad()] })}`);
  });
}
