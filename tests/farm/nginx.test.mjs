// nginx with the shipped configuration as a cache before one node.
//   node tests/farm/nginx.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parseArgs } from 'node:util';

import { ask, askJson } from '../support/http.mjs';
import { makeRoot, startServer } from '../support/server.mjs';
import { startNginx } from './proxies.mjs';

const { values: paths } = parseArgs({
  options: { chamferd: { type: 'string' }, chamferprep: { type: 'string' }, data: { type: 'string' } },
});

const KEY = 'a-key-for-this-test-only';
const AUTHORIZED = { Authorization: `Bearer ${KEY}` };
const AT_ONCE = 8;

let root;
let options;
let node;
let cache;
let scene; // path of the scene by its id

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data, ['blocks.scene.json']);
  const keys = join(root.root, '.keys');
  writeFileSync(keys, `${KEY}\n`);
  options = ['--key-file', keys, '--behind-proxy', '--log-level', 'warning'];
  node = await startServer(paths.chamferd, root.root, 0, options);
  cache = await startNginx(node.port);
  scene = `/v1/scenes/${(await askJson(`${node.url}/v1/scenes/blocks`, { headers: AUTHORIZED })).id}`;
});

after(async () => {
  await cache?.stop();
  await node?.stop();
  root?.remove();
});

/** Through the cache, with the key. */
function fetchPath(path, { headers, ...rest } = {}) {
  return ask(cache.url + path, { headers: { ...AUTHORIZED, ...headers }, ...rest });
}

test('a tile is rendered once; from then on the cache has the same bytes, ETag and 304', async () => {
  const path = `${scene}/tiles/256x256/64,64,64,64/0-4.f16?radius=0.04`;
  const direct = await ask(node.url + path, { headers: AUTHORIZED });
  const first = await fetchPath(path);
  const second = await fetchPath(path);
  assert.deepEqual([direct, first, second].map(({ status }) => status), [200, 200, 200]);
  assert.equal(first.headers['x-cache'], 'MISS');
  assert.equal(second.headers['x-cache'], 'HIT');
  assert.equal(second.headers['x-request-id'], first.headers['x-request-id'], 'the node was not asked again');
  for (const { body, headers } of [first, second]) {
    assert.deepEqual(body, direct.body);
    for (const name of ['etag', 'cache-control', 'content-type', 'x-content-type-options', 'x-chamfer-rays'])
      assert.equal(headers[name], direct.headers[name], name);
  }
  assert.match(direct.headers.etag, /^"/, 'strong');

  const same = await fetchPath(path, { headers: { 'If-None-Match': direct.headers.etag } });
  assert.equal(same.status, 304);
  assert.equal(same.headers.etag, direct.headers.etag);
  assert.equal(same.body.length, 0);
});

test('clients that want the same new tile at one time have it rendered once', async () => {
  const path = `${scene}/tiles/256x256/0,0,128,128/0-16.f16`;
  const answers = await Promise.all(Array.from({ length: AT_ONCE }, () => fetchPath(path)));
  assert.ok(answers.every(({ status, body }) => status === 200 && body.equals(answers[0].body)));
  assert.equal(new Set(answers.map(({ headers }) => headers['x-request-id'])).size, 1);
  assert.equal(answers.filter(({ headers }) => headers['x-cache'] === 'MISS').length, 1);
});

test('HEAD is answered without rendering', async () => {
  const path = `${scene}/tiles/4096x4096/0,0,1024,1024/0-2048.png`; // minutes
  const { status, headers } = await fetchPath(path, { method: 'HEAD', patience: 10_000 });
  assert.equal(status, 200);
  assert.match(headers.etag, /^"/);
});

test('errors and redirects are not kept', async () => {
  for (const [path, status] of [
    [`${scene}/tiles/64x64/0,0,64,64/0-1.gif`, 400],
    [`${scene}/tiles/64x64/0,0,64,64/0-1.png?radius=1000`, 422],
    ['/v1/scenes/none/tiles/64x64/0,0,64,64/0-1.png', 404],
    ['/v1/scenes/blocks/tiles/64x64/0,0,64,64/0-1.png', 307],
  ]) {
    const answers = [await fetchPath(path), await fetchPath(path)];
    for (const answer of answers) {
      assert.equal(answer.status, status, path);
      assert.equal(answer.headers['x-cache'], 'MISS', path);
      assert.equal(answer.headers['cache-control'], 'no-store', path);
    }
    assert.notEqual(answers[0].headers['x-request-id'], answers[1].headers['x-request-id']);
  }
});

test("a node's metrics are not for everybody", async () => {
  assert.equal((await ask(`${node.url}/metrics`, { headers: AUTHORIZED })).status, 200);
  assert.equal((await fetchPath('/metrics')).status, 404);
});

test('nobody without a key is served from the cache', async () => {
  const path = `${scene}/tiles/64x64/0,0,64,64/0-1.png`;
  assert.equal((await fetchPath(path)).status, 200);
  assert.equal((await fetchPath(path)).headers['x-cache'], 'HIT');
  assert.equal((await ask(cache.url + path)).status, 401);
  assert.equal((await ask(cache.url + path, { headers: { Authorization: 'Bearer another-key-of-some-length' } })).status, 403);
  assert.equal((await ask(cache.url + path, { headers: { 'X-Api-Key': 'another-key-of-some-length' } })).status, 403);
});

test('what is in the cache outlives the node, and what failed meanwhile is rendered when it is back', async () => {
  const kept = `${scene}/tiles/64x64/0,0,32,32/0-1.png`;
  const later = `${scene}/tiles/64x64/32,32,32,32/0-1.png`;
  const { body } = await fetchPath(kept);
  await node.kill();
  const hit = await fetchPath(kept);
  assert.equal(hit.headers['x-cache'], 'HIT');
  assert.deepEqual(hit.body, body);
  assert.equal((await fetchPath(later)).status, 502);

  node = await startServer(paths.chamferd, root.root, node.port, options);
  // nginx passes a failed upstream over for ten seconds, unless it is the only one.
  const back = await fetchPath(later);
  assert.equal(back.status, 200);
  assert.equal(back.headers['x-cache'], 'MISS');
  const direct = await ask(node.url + later, { headers: AUTHORIZED });
  assert.deepEqual(back.body, direct.body);
  assert.equal((await fetchPath('/livez', { patience: 5_000 })).status, 200);
});
