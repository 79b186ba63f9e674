// The renderer on canvases that remember nothing, with a server that answers when it is told to.
import assert from 'node:assert/strict';
import { afterEach, beforeEach, test } from 'node:test';

import { Renderer } from '../../../web/renderer.js';

const { fetch } = globalThis;
const camera = { eye: [3, -4, 2], target: [0, 0, 0], up: [0, 0, 1], vfovDegrees: 30 };
const view = (rounding, radius = null) => ({ sceneId: 's', camera, rounding, radius });
const turn = () => new Promise((resolve) => setTimeout(resolve, 0));

let asked; // {url, answer(), isAborted()}[]
let renderer;
let status;
let map;

function fakeCanvas() {
  const context = {
    createImageData: (width, height) => ({ data: new Uint8ClampedArray(4 * width * height) }),
    putImageData() {},
    drawImage() {},
    fillRect() {},
  };
  return { width: 512, height: 256, getContext: () => context };
}

beforeEach(() => {
  asked = [];
  globalThis.document = { createElement: fakeCanvas };
  globalThis.fetch = (url, { signal }) =>
    new Promise((resolve, reject) => {
      const [, width, height] = /\/\d+,\d+,(\d+),(\d+)\//.exec(url).map(Number);
      const [, first, end] = /\/(\d+)-(\d+)\.f16/.exec(url).map(Number);
      const body = new Uint32Array(4 + 2 * width * height);
      body.set([0x36315443, width, height, end - first]); // "CT16"
      signal.addEventListener('abort', () => reject(new DOMException('stopped', 'AbortError')));
      asked.push({ url, answer: () => resolve(new Response(body.buffer)), isAborted: () => signal.aborted });
    });
  map = { show() {}, hide() {}, forget() {}, resize() {}, take() {}, showCoarse() {} };
  renderer = new Renderer([fakeCanvas(), fakeCanvas()], map, { total: 4, onStatus: (now) => (status = now) });
});
afterEach(() => {
  globalThis.fetch = fetch;
  delete globalThis.document;
});

/** Answers until `count` requests were made and answered, or nothing is asked any more; their roundings and places. */
async function serve(count = Infinity) {
  const served = [];
  while (served.length < count) {
    await turn();
    const next = asked.find((one) => !one.isServed && !one.isAborted());
    if (!next) break;
    next.isServed = true;
    next.answer();
    for (let i = 0; i < 4; i++) await turn();
    const [, size, place, range] = /tiles\/(\w+)\/([\d,]+)\/([\d-]+)/.exec(next.url);
    served.push({ isCoarse: size !== '512x256', rounding: /rounding=([\w:]+)/.exec(next.url)[1], place, range });
  }
  return served;
}

const TILES = 2 * 3; // two places, three passes

test('without a comparison one picture is asked for, once', async () => {
  renderer.show([view('analytic')]);
  const served = await serve();
  assert.equal(served.length, TILES);
  assert.ok(served.every(({ isCoarse }) => !isCoarse));
  assert.deepEqual([status.phase, status.samples], ['done', 4]);
});

test('both sides of a place are asked for one after the other, three at a time at most', async () => {
  renderer.show([view('none'), view('analytic')]);
  assert.equal((await serve(2)).filter(({ isCoarse }) => isCoarse).length, 2); // what was there goes at once
  await turn();
  assert.equal(asked.filter(({ isServed }) => !isServed).length, 3);
  const served = await serve();
  assert.equal(served.length, 2 * TILES);
  for (let i = 0; i < served.length; i += 2) {
    assert.deepEqual([served[i].rounding, served[i + 1].rounding], ['none', 'analytic']);
    assert.deepEqual([served[i].place, served[i].range], [served[i + 1].place, served[i + 1].range]);
  }
});

test('equal sides are one picture', async () => {
  renderer.show([view('none'), view('none')]);
  assert.equal((await serve()).filter(({ isCoarse }) => !isCoarse).length, TILES);
});

test('changing one side, swapping the two or turning one off keeps the other’s tiles', async () => {
  renderer.show([view('none'), view('analytic')]);
  await serve();
  renderer.show([view('none'), view('mesh:4')]);
  const after = await serve();
  assert.ok(after.every(({ rounding }) => rounding === 'mesh:4'));
  assert.equal(after.filter(({ isCoarse }) => !isCoarse).length, TILES);
  renderer.show([view('mesh:4'), view('none')]);
  assert.deepEqual(await serve(), []);
  renderer.show([view('mesh:4')]);
  assert.deepEqual(await serve(), []);
  assert.equal(status.phase, 'done');
});

test('what a side no longer shows is given up, what the other has under way is not', async () => {
  renderer.show([view('none'), view('analytic')]);
  await serve(2);
  await turn();
  renderer.show([view('none'), view('bevel:4')]);
  for (const { url, isAborted, isServed } of asked) {
    if (!isServed) assert.equal(isAborted(), url.includes('rounding=analytic'), url);
  }
  const served = await serve();
  assert.equal(served.filter(({ rounding, isCoarse }) => rounding === 'none' && !isCoarse).length, TILES);
  assert.ok(!served.some(({ rounding }) => rounding === 'analytic'));
  assert.deepEqual([status.phase, status.samples], ['done', 4]);
});

test('a difference takes tiles of the two that are shown only', async () => {
  const taken = [];
  map.take = (side) => taken.push(side.view.rounding);
  renderer.show([view('none'), view('analytic')], { difference: true });
  await serve();
  assert.equal(taken.length, 2 * TILES);
  renderer.show([view('none'), view('mesh:2')], { difference: true });
  taken.length = 0;
  await serve();
  assert.deepEqual([...new Set(taken)], ['mesh:2']);
});
