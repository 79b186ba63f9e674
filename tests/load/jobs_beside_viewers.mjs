// What people at the page notice of jobs: the time of small tiles of 20 viewers who drag, without and with 100
// comparisons that wait. Run by hand on a machine that does nothing else:
//   node tests/load/jobs_beside_viewers.mjs --chamferd PATH --chamferprep PATH --data FOLDER [--seconds 20] [--rounds 3]
// Prints a line of JSON a phase and the ratios of the medians over all rounds; exit status 1 where the median of the
// tiles with jobs is more than 1.5 times that without.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import http from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

import { ask, askJson, percentile, sleep } from '../support/http.mjs';
import { makeRoot } from '../support/server.mjs';
import { rounded, startSubject } from './subject.mjs';

const VIEWERS = 20;
const JOBS = 100;
const LARGEST_RATIO = 1.5;

const { values: given } = parseArgs({
  options: {
    chamferd: { type: 'string' },
    chamferprep: { type: 'string' },
    data: { type: 'string' },
    seconds: { type: 'string', default: '20' },
    rounds: { type: 'string', default: '3' },
    pause: { type: 'string', default: '100' },
  },
});

/** The camera of a viewer who turns about the bricks. */
const cameraAt = (angle) => `${9 * Math.cos(angle)},${9 * Math.sin(angle)},5,0,0,1,0,0,1,40`;

/** Viewers ask for one small tile after the other; `pause`: milliseconds between an answer and the next question. */
async function drag(subject, seconds, pause) {
  const times = [];
  const agent = new http.Agent({ keepAlive: true });
  const end = performance.now() + seconds * 1000;
  await Promise.all(
    Array.from({ length: VIEWERS }, async (_, viewer) => {
      await sleep((pause * viewer) / VIEWERS);
      for (let i = 0; performance.now() < end; i++) {
        const camera = cameraAt(viewer + i * 0.02);
        const { status, ms } = await ask(subject.tile(`320x180/128,64,64,64/0-1.f16?camera=${camera}`), { agent });
        assert.equal(status, 200);
        times.push(ms);
        if (pause > 0) await sleep(pause);
      }
    }),
  );
  agent.destroy();
  return times;
}

async function submit(subject, number) {
  const suite = {
    schema: 'chamfer.cases/1',
    cases: [{ name: `job ${number}`, a: 'blocks', b: `blocks?seed=${1000 * (number + 1)}`, width: 320, height: 180, seeds: 256 }],
  };
  const { status, body } = await ask(`${subject.url}/v1/comparisons`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify(suite),
  });
  assert.equal(status, 202, `${body}`);
}

const figures = (times) => ({
  tiles: times.length,
  p50: rounded(percentile(times, 0.5)),
  p95: rounded(percentile(times, 0.95)),
  p99: rounded(percentile(times, 0.99)),
});

async function seedsDone(subject) {
  const list = await askJson(`${subject.url}/v1/comparisons`);
  const running = list.find(({ state }) => state === 'running');
  return `${list.filter(({ state }) => state === 'done').length} jobs and ${running?.progress?.seeds ?? 0} seeds`;
}

const made = makeRoot(given.chamferprep, given.data, ['blocks.scene.json']);
const jobs = mkdtempSync(join(tmpdir(), 'chamfer-jobs-'));
const all = { without: [], with: [] };
try {
  for (let round = 0; round < Number(given.rounds); round++) {
    // A server without jobs, then one that has a hundred: the same program, one after the other.
    for (const phase of ['without', 'with']) {
      const subject = await startSubject({ chamferd: given.chamferd, root: made.root }, ['--jobs', join(jobs, `${round}`)]);
      if (phase === 'with') for (let i = 0; i < JOBS; i++) await submit(subject, i);
      await drag(subject, 2, Number(given.pause));
      const times = await drag(subject, Number(given.seconds), Number(given.pause));
      const { queued, running } = (await askJson(`${subject.url}/v1/info`)).comparisons;
      if (phase === 'with') assert.ok(queued + running > JOBS / 2, `${queued} jobs still wait`);
      console.log(JSON.stringify({ round, phase, ...figures(times), queued, running, done: await seedsDone(subject) }));
      all[phase].push(...times);
      await subject.stop();
    }
  }
} finally {
  made.remove();
  rmSync(jobs, { recursive: true, force: true });
}
const [without, beside] = [figures(all.without), figures(all.with)];
const ratio = (name) => Math.round((100 * beside[name]) / without[name]) / 100;
console.log(JSON.stringify({ without, with: beside, ratio: { p50: ratio('p50'), p95: ratio('p95'), p99: ratio('p99') } }));
process.exitCode = ratio('p50') <= LARGEST_RATIO ? 0 : 1;
