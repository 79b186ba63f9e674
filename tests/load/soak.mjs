// An hour of random valid requests, as ten a second make 36,000, as fast as they are answered: memory stays flat, and
// whatever was answered once is answered with the same bytes at the end, by this process and by another.
import assert from 'node:assert/strict';
import http from 'node:http';

import { ask, askJson, digest, inParallel, percentile } from '../support/http.mjs';
import { randomRequest } from './random_request.mjs';
import { memoryOf, probeHealth, randomFrom, rounded, startSubject } from './subject.mjs';

const HOUR = 36_000;
const QUICK = 1_200;
const CLIENTS = 6;
const KEPT = 300; // requests that are asked again at the end
const CACHE_MEGABYTES = 16;
// What memory may grow by between the warm-up and the end: the cache of prepared scenes is full by then and has its own
// bound, so that growth is a leak, or the allocator's: its arenas settle within this many megabytes. Over an hour's
// requests a leak of 1.4 kB each would show.
const GROWTH_MEGABYTES = 48;

export async function soak(settings) {
  const options = ['--cache-megabytes', `${CACHE_MEGABYTES}`];
  const server = await startSubject(settings, ['--threads', '1', ...options]);
  const random = randomFrom(settings.seed);
  const scenes = (await askJson(`${server.url}/v1/scenes`)).filter(({ state }) => state === 'ready');
  const requests = Array.from({ length: settings.quick ? QUICK : HOUR }, () =>
    randomRequest(random, scenes[Math.floor(random() * scenes.length)]),
  );
  const agent = new http.Agent({ keepAlive: true });
  const fetchAnswer = async (url, request) => {
    const answer = await ask(url + request.path, { ...request, agent });
    assert.equal(answer.status, 200, `${request.method} ${request.path} ${request.body ?? ''}: ${answer.body}`);
    return answer;
  };
  const kept = [];
  const keepEvery = Math.ceil(requests.length / KEPT);
  let warm;
  try {
    const health = probeHealth(server.url, 200);
    const times = [];
    const began = performance.now();
    await inParallel(requests, CLIENTS, async (request, i) => {
      const { ms, body } = await fetchAnswer(server.url, request);
      times.push(ms);
      if (i % keepEvery === 0) kept.push({ request, digest: digest(body) });
      if (times.length === Math.floor(requests.length / 4)) warm = memoryOf(server.pid);
    });
    const seconds = (performance.now() - began) / 1000;
    const end = memoryOf(server.pid);
    const { prepared_scenes: cache } = await askJson(`${server.url}/v1/info`);
    const livez = await health.end();

    for (const { request, digest: before } of kept)
      assert.equal(digest((await fetchAnswer(server.url, request)).body), before, request.path);
    if (!settings.instrumented)
      assert.ok(end.now <= warm.now + GROWTH_MEGABYTES, `${warm.now} MB after the warm-up, ${end.now} MB at the end`);
    const alive = await server.assertHealthy();
    await server.stop();

    const other = await startSubject(settings, ['--threads', '3', ...options]);
    try {
      for (const { request, digest: before } of kept)
        assert.equal(digest((await fetchAnswer(other.url, request)).body), before, request.path);
    } finally {
      await other.stop();
    }
    return {
      requests: requests.length,
      perSecond: rounded(requests.length / seconds),
      p50: rounded(percentile(times, 0.5)),
      p99: rounded(percentile(times, 0.99)),
      askedAgain: 2 * kept.length,
      memoryMegabytes: { warm: warm.now, end: end.now, most: end.most },
      cache: { builds: cache.builds, hits: cache.hits, megabytes: rounded(cache.bytes / 1048576) },
      livez,
      livezAfter: rounded(alive),
    };
  } finally {
    agent.destroy();
    await server.kill();
  }
}
