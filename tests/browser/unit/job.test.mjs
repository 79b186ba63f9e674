import assert from 'node:assert/strict';
import { afterEach, test } from 'node:test';

import { Job, suiteOf } from '../../../web/job.js';

const { fetch } = globalThis;
afterEach(() => (globalThis.fetch = fetch));

const camera = { eye: [3, -4, 2], target: [0, 0, 0], up: [0, 0, 1], vfovDegrees: 30 };
const side = (name, rounding, radius, ids = ['1', '1']) => ({
  scene: { name, id: ids[0], listedId: ids[1] },
  view: { sceneId: ids[0], camera, rounding, radius },
});
const frame = { width: 320, height: 200 };

test('a suite of one case asks for the two sides as they are seen', () => {
  const suite = suiteOf([side('blocks', 'none', 0.05), side('blocks', 'mesh:4', 0.05)], frame);
  assert.deepEqual(suite, {
    schema: 'chamfer.cases/1',
    cases: [{
      name: 'blocks: no rounding against mesh of 4 segments, radius 0.05',
      a: 'blocks?camera=3,-4,2,0,0,0,0,0,1,30&rounding=none',
      b: 'blocks?camera=3,-4,2,0,0,0,0,0,1,30&rounding=mesh:4&radius=0.05',
      width: 320,
      height: 200,
    }],
  });
});

test('scenes that a name does not tell go by their id', () => {
  const turned = side('solids/a', 'analytic', null, ['y1', 'z1']);
  const odd = side('what?is=this', 'analytic', null);
  const [one] = suiteOf([turned, odd], frame).cases;
  assert.match(one.a, /^y1\?camera/);
  assert.match(one.b, /^1\?camera/);
  assert.equal(one.name, 'solids/a (analytic) against what?is=this (analytic)');
});

test('a job is followed to its end, a fault of the server is told, a later job takes its place', async () => {
  const answers = [
    [202, { id: 'j', state: 'queued' }], [200, { id: 'j', state: 'running' }], [503, { detail: 'busy' }],
    [200, { id: 'j', state: 'done', outcome: 'same' }],
  ];
  const asked = [];
  globalThis.fetch = async (url, { method = 'GET' }) => {
    asked.push(`${method} ${url}`);
    const [status, body] = answers.shift();
    return new Response(JSON.stringify(body), { status, headers: status === 503 ? { 'Retry-After': '0' } : {} });
  };
  const seen = [];
  const job = new Job({ onNews: ({ state }) => seen.push(state), onFault: (error) => error && seen.push(error.message) });
  await job.start({});
  assert.deepEqual(seen, ['queued', 'running', 'busy', 'done']);
  assert.deepEqual(asked, ['POST v1/comparisons', ...new Array(3).fill('GET v1/comparisons/j')]);

  answers.push([422, { detail: 'cases[0].a: too large' }]);
  await job.start({});
  assert.equal(seen.at(-1), 'cases[0].a: too large');
});
