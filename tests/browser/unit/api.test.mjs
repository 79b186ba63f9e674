import assert from 'node:assert/strict';
import { afterEach, test } from 'node:test';

import { fetchHit, fetchScene, fetchScenes, fetchTile, fetchUpright, ServerError } from '../../../web/api.js';

const { fetch } = globalThis;
afterEach(() => (globalThis.fetch = fetch));

/** A body that ends after `bytes`, as a broken connection ends it. */
const broken = (bytes, error = new TypeError('network error')) =>
  new ReadableStream({
    start(stream) {
      stream.enqueue(new TextEncoder().encode(bytes));
      stream.error(error);
    },
  });
const answer = (body) => (globalThis.fetch = async () => new Response(body, { status: 200 }));

const view = { sceneId: 'a', rounding: 'analytic', radius: null };
const ray = { origin: [0, 0, 0], direction: [0, 0, 1] };
const calls = [
  ['scenes', () => fetchScenes()],
  ['scene', () => fetchScene('a/b')],
  ['tile', () => fetchTile('v1/tile')],
  ['hit', () => fetchHit(view, ray)],
];

for (const [name, call] of calls) {
  test(`${name}: an answer cut short is a passing fault, however it ends`, async () => {
    const bodies = [() => broken('CT16'), () => broken('[{"name":'), () => '{"hits":[', () => 'CT16\u0001', () => ''];
    for (const body of bodies) {
      answer(body());
      await assert.rejects(call(), (error) => {
        assert.ok(error instanceof ServerError, `${error}`);
        assert.ok(error.passing);
        assert.match(error.message, /cut short/);
        return true;
      });
    }
  });

  test(`${name}: who aborts it is not told of a fault`, async () => {
    answer(broken('CT16', new DOMException('stopped', 'AbortError')));
    await assert.rejects(call(), { name: 'AbortError' });
  });
}

test('a bare mesh is asked for by the id that has the wished axis up', async () => {
  const camera = { eye: [0, 0, 0], target: [1, 0, 0], up: [0, 0, 1], vfov_degrees: 40 };
  const scene = (id, current) => ({ id, camera, up_axis: { current, ids: { y: 'idy', z: 'idz' } } });
  const answers = { 'v1/scenes/a': scene('idz', 'z'), 'v1/scenes/idy': scene('idy', 'y') };
  globalThis.fetch = async (url) => new Response(JSON.stringify(answers[url]), { status: 200 });
  for (const [up, id] of [[null, 'idz'], ['z', 'idz'], ['y', 'idy']]) {
    const found = await fetchUpright('a', up);
    assert.equal(found.id, id);
    assert.equal(found.listedId, 'idz');
  }
  answers['v1/scenes/a'].up_axis = null; // of a scene file
  assert.equal((await fetchUpright('a', 'y')).id, 'idz');
});
