// Is what `chamferd compare` says true as often as it states? Real renders, by the program itself:
//  - 1000 comparisons of a scene with itself, with other seeds on either side and against references with
//    their variance: "differs" may come as often as the significance, 0.05 here, and no more;
//  - a radius 1 % larger, a light 0.5 % brighter, one brick moved, a roughness 0.02 higher: each is to be found
//    within the stated budget of seeds, in each of several runs with other seeds.
// Run by hand: node tests/bench/calibrate_compare.mjs [PROGRAM] [--runs N]; it takes about half an hour on two cores.
import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const here = new URL('.', import.meta.url).pathname;
const data = resolve(here, '../../data');
const options = process.argv.slice(2);
const runsAt = options.indexOf('--runs');
const RUNS = runsAt < 0 ? 1000 : Number(options.splice(runsAt, 2)[1]);
const program = resolve(options[0] ?? resolve(here, '../../build/release/server/chamferd'));
const SIGNIFICANCE = 0.05;

const folder = mkdtempSync(join(tmpdir(), 'chamfer-calibration-'));
for (const part of ['bricks', 'solids', 'stage']) cpSync(join(data, part), join(folder, part), { recursive: true });

/** A bundled scene, changed, in the folder. */
function scene(name, from, change = () => {}) {
  const json = JSON.parse(readFileSync(join(data, `${from}.scene.json`), 'utf8'));
  change(json);
  writeFileSync(join(folder, `${name}.scene.json`), JSON.stringify(json));
  return `${name}.scene.json`;
}

/** Results of the cases, which `defaults` are laid under. */
function compare(name, defaults, cases, more = []) {
  const file = join(folder, `${name}.cases.json`);
  writeFileSync(file, JSON.stringify({ schema: 'chamfer.cases/1', defaults, cases }));
  const run = spawnSync(program, ['compare', '--suite', file, '--json', '-', ...more],
    { maxBuffer: 1 << 30, stdio: ['ignore', 'pipe', 'inherit'] });
  if (more.includes('--update')) return [];
  const { cases: results } = JSON.parse(run.stdout);
  for (const one of results) if (one.outcome === 'error') throw new Error(`${one.name}: ${one.reason}`);
  return results;
}

const count = (results, outcome) => results.filter((one) => one.outcome === outcome).length;
const median = (numbers) => [...numbers].sort((a, b) => a - b)[numbers.length >> 1];

/** Most false alarms that a true rate of `p` gives in `n` runs with a probability of 0.999. */
function mostAlarms(n, p) {
  let term = (1 - p) ** n;
  let sum = term;
  let k = 0;
  while (sum < 0.999) sum += term *= ((n - k) / ++k) * (p / (1 - p));
  return k;
}

function falseAlarms() {
  const a = scene('same', 'dice');
  const defaults = { width: 48, height: 27, samples: 2, seeds: 32, statistics: { significance: SIGNIFICANCE } };
  const seeds = (run) => `${a}?seed=${run * 100}`;
  const report = (what, results) => {
    const alarms = count(results, 'differs');
    const most = mostAlarms(results.length, SIGNIFICANCE);
    console.log(`${what}: ${alarms} false alarms in ${results.length} (stated: at most ${100 * SIGNIFICANCE} %, which gives at most ${most}); `
      + `${count(results, 'same')} same, ${count(results, 'cannot-tell')} cannot tell`);
    return alarms <= most;
  };
  const half = RUNS / 2;
  const independent = Array.from({ length: half }, (_, i) => ({ name: `${i}`, a: seeds(2 * i), b: seeds(2 * i + 1) }));
  const references = Array.from({ length: half }, (_, i) => ({ name: `${i}`, a: seeds(1e5 + 2 * i), b: `reference-${i % 100}.exr` }));
  compare('references', { ...defaults, statistics: true, seeds: 128 },
    references.slice(0, 100).map((c, i) => ({ ...c, a: seeds(1e6 + 2 * i) })), ['--update', '--quiet']);
  return [report('two renders, seeds of their own', compare('independent', defaults, independent)),
    report('a render against a reference of 128 seeds', compare('against', defaults, references))].every(Boolean);
}

function found() {
  const dice = scene('dice', 'dice');
  const blocks = scene('blocks', 'blocks');
  const changes = [
    ['radius + 1 %', scene('radius', 'dice', (s) => s.meshes.forEach((m) => { if (m.radius) m.radius *= 1.01; })), dice],
    ['light + 0.5 %', scene('light', 'dice', (s) => { s.lights[0].emission = s.lights[0].emission.map((e) => e * 1.005); }), dice],
    ['one brick moved by 0.05', scene('moved', 'blocks', (s) => { s.instances[2].translate[0] += 0.05; }), blocks],
    ['roughness + 0.02', scene('rough', 'dice', (s) => { s.materials[0].roughness += 0.02; }), dice],
  ];
  const SEEDS = 64;
  let good = true;
  for (const [what, a, b] of changes) {
    const runs = Array.from({ length: 10 }, (_, i) => ({ name: `${i}`, a: `${a}?seed=${i * 1000}`, b: `${b}?seed=${i * 1000}` }));
    const results = compare('found', { width: 160, height: 90, samples: 4, seeds: SEEDS }, runs);
    const hits = count(results, 'differs');
    console.log(`${what}: found in ${hits} of ${results.length}, after ${median(results.map((r) => r.a.seeds))} seeds of 4 samples `
      + `(median; budget ${SEEDS}), at significance 0.01, 160x90, ${median(results.map((r) => r.seconds)).toFixed(1)} s`);
    good &&= hits === results.length;
  }
  return good;
}

try {
  console.log(execFileSync(program, ['--version'], { encoding: 'utf8' }).trim());
  const good = [found(), falseAlarms()].every(Boolean);
  console.log(good ? 'calibrated' : 'NOT as stated');
  process.exitCode = good ? 0 : 1;
} finally {
  rmSync(folder, { recursive: true, force: true });
}
