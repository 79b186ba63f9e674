// Three nodes behind HAProxy with the shipped configuration: one dies, one drains, one comes back, and no tile is lost.
//   node tests/farm/haproxy.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER
import assert from 'node:assert/strict';
import http from 'node:http';
import { after, before, test } from 'node:test';
import { parseArgs } from 'node:util';

import { ask, askJson, digest, inParallel, sleep } from '../support/http.mjs';
import { makeRoot, startServer } from '../support/server.mjs';
import { startHaproxy } from './proxies.mjs';

const { values: paths } = parseArgs({
  options: { chamferd: { type: 'string' }, chamferprep: { type: 'string' }, data: { type: 'string' } },
});

const FRAME = 384;
const TILE = 32;
const CLIENTS = 16;
const NODE_OPTIONS = ['--threads', '1', '--behind-proxy', '--drain-delay', '5', '--log-level', 'warning'];
const PATIENCE_MS = 30_000;
const BOTH_CORES = 2;

let root;
let nodes = [];
let proxy;
let agent;
let tiles; // paths
let wanted; // their digests, from one node

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data, ['blocks.scene.json']);
  for (let i = 0; i < 3; ++i) nodes.push(await startServer(paths.chamferd, root.root, 0, NODE_OPTIONS));
  proxy = await startHaproxy(nodes.map((node) => node.port));
  agent = new http.Agent({ keepAlive: true });

  const { id } = await askJson(`${nodes[0].url}/v1/scenes/blocks`);
  tiles = [];
  for (let y = 0; y < FRAME; y += TILE)
    for (let x = 0; x < FRAME; x += TILE)
      tiles.push(`/v1/scenes/${id}/tiles/${FRAME}x${FRAME}/${x},${y},${TILE},${TILE}/0-16.f16`);
  const answers = await inParallel(tiles, BOTH_CORES, (path) => ask(nodes[0].url + path));
  assert.ok(answers.every(({ status }) => status === 200));
  wanted = answers.map(({ body }) => digest(body));
});

after(async () => {
  agent?.destroy();
  await proxy?.stop();
  for (const node of nodes) await node.stop();
  root?.remove();
});

/**
 * Renders the frame tile by tile through HAProxy; `halfWay()` is called once, when half of the tiles are there. Every tile
 * must arrive and be right. Returns how many transfers were cut short and had to be asked for again: the one thing that
 * a proxy cannot mend, because the first bytes had already gone to the client.
 */
async function renderFrame(halfWay) {
  let arrived = 0;
  let cutShort = 0;
  let event;
  const fetchTile = async (path, i) => {
    for (;;) {
      try {
        const { status, body } = await ask(proxy.url + path, { agent });
        assert.equal(status, 200, body.toString());
        assert.equal(digest(body), wanted[i], path);
        break;
      } catch (error) {
        if (error instanceof assert.AssertionError) throw error;
        ++cutShort;
        assert.ok(cutShort <= CLIENTS, `more transfers were cut short than there are clients: ${error.message}`);
      }
    }
    if (++arrived === tiles.length / 2) event = halfWay();
  };
  await inParallel(tiles, CLIENTS, fetchTile);
  await event;
  return cutShort;
}

/** Requests that HAProxy logged in the backend that renders, by node. */
function share(log) {
  const counts = { node1: 0, node2: 0, node3: 0 };
  for (const [, name] of log.matchAll(/ render\/(node\d) /g)) ++counts[name];
  return counts;
}

async function until(condition, what) {
  for (const began = Date.now(); !(await condition()); await sleep(10))
    assert.ok(Date.now() - began < PATIENCE_MS, `${what} within ${PATIENCE_MS / 1000} s`);
}

async function assertHealthy() {
  const live = await ask(`${proxy.url}/livez`, { patience: 5_000 });
  assert.equal(live.status, 200);
  const { status, body } = await ask(proxy.url + tiles[0]);
  assert.equal(status, 200);
  assert.equal(digest(body), wanted[0]);
}

test('one scene keeps to one node while that is enough, and spreads over all under load', async () => {
  let from = proxy.log().length;
  for (const path of tiles.slice(0, 12)) await ask(proxy.url + path, { agent });
  await until(() => proxy.log().slice(from).split(' render/').length > 12, 'twelve requests are logged');
  const alone = share(proxy.log().slice(from));
  assert.equal(Math.max(...Object.values(alone)), 12, JSON.stringify(alone));

  from = proxy.log().length;
  assert.equal(await renderFrame(async () => {}), 0);
  await until(() => proxy.log().slice(from).split(' render/').length > tiles.length, 'every request is logged');
  const spread = share(proxy.log().slice(from));
  for (const count of Object.values(spread)) assert.ok(count >= tiles.length / 6, JSON.stringify(spread));
});

test('a node that is killed half way costs no tile', async (t) => {
  const from = proxy.log().length;
  const cutShort = await renderFrame(async () => {
    await until(async () => (await askJson(`${nodes[0].url}/v1/info`)).queue.running > 0, 'the node renders');
    assert.equal(await nodes[0].kill(), 'SIGKILL');
  });
  // What it had under way either went to another node ("/+" and the number of tries) or was cut short.
  await until(() => proxy.log().slice(from).split(' render/').length > tiles.length, 'every request is logged');
  const sentOn = proxy.log().slice(from).match(/\/\+\d+ /g)?.length ?? 0;
  t.diagnostic(`${tiles.length} tiles asked for, none lost; ${sentOn} sent on by HAProxy, ${cutShort} asked for again`);
  assert.ok(sentOn + cutShort >= 1);
  await assertHealthy();
});

test('a node that comes back is used again', async () => {
  nodes[0] = await startServer(paths.chamferd, root.root, nodes[0].port, NODE_OPTIONS);
  const from = proxy.log().length;
  await until(async () => {
    await inParallel(tiles.slice(0, 12), 12, (path) => ask(proxy.url + path, { agent }));
    return share(proxy.log().slice(from)).node1 > 0;
  }, 'the node has work');
});

test('a node that drains finishes what it has and costs nobody anything', async () => {
  let ended;
  const cutShort = await renderFrame(async () => {
    await until(async () => (await askJson(`${nodes[1].url}/v1/info`)).queue.running > 0, 'the node renders');
    ended = nodes[1].stop();
  });
  assert.equal(cutShort, 0);
  assert.equal(await ended, 0, 'exit status');
  await assertHealthy();
  nodes[1] = await startServer(paths.chamferd, root.root, nodes[1].port, NODE_OPTIONS);
});

test('one request of a client is not kept waiting by the many of another', async () => {
  // The crowd fills the nodes' queues and HAProxy's.
  let others = 0;
  const many = Array.from({ length: 2 * tiles.length }, (_, i) => `${tiles[i % tiles.length]}?seed=${i}`);
  const crowd = inParallel(many, many.length, async (path) => {
    const { status } = await ask(proxy.url + path, { localAddress: '127.0.0.1' });
    assert.equal(status, 200);
    ++others;
  });
  await until(() => others > 0, 'the crowd is served');
  const { status } = await ask(`${proxy.url}${tiles[0]}`, { localAddress: '127.0.0.2' });
  assert.equal(status, 200);
  assert.ok(others < many.length * 0.75, `${others} of ${many.length} came before it`);
  await crowd;
  await assertHealthy();
});

test('a client that leaves frees its slot through HAProxy too', async (t) => {
  const running = async () => {
    const queues = await Promise.all(nodes.map((node) => askJson(`${node.url}/v1/info`)));
    return queues.reduce((sum, { queue }) => sum + queue.running, 0);
  };
  const minutesLong = tiles[0].replace(/tiles.*/, 'tiles/4096x4096/0,0,1024,1024/0-1024.f16');
  let leave;
  const answer = ask(proxy.url + minutesLong, { cancel: (f) => (leave = f) }).catch(() => 'left');
  await until(async () => (await running()) === 1, 'it is rendered');
  const began = performance.now();
  leave();
  await until(async () => (await running()) === 0, 'the slot is free');
  const ms = performance.now() - began;
  t.diagnostic(`slot free after ${Math.round(ms)} ms`);
  assert.ok(ms < 1_000);
  assert.equal(await answer, 'left');
});

test("a node's metrics are not for everybody", async () => {
  assert.equal((await ask(`${nodes[0].url}/metrics`)).status, 200);
  assert.equal((await ask(`${proxy.url}/metrics`)).status, 404);
});

test('without any node the answer is 503 and says when to come back', async () => {
  await Promise.all(nodes.map((node) => node.kill()));
  const { status, headers } = await ask(proxy.url + tiles[0]);
  assert.equal(status, 503);
  assert.equal(headers['retry-after'], '5');
});
