// An hour of random valid requests, as ten a second make 36,000, as fast as they are answered: memory stays flat, and
// whatever was answered once is answered with the same bytes at the end, by this process and by another.
import assert from 'node:assert/strict';
import http from 'node:http';

import { ask, askJson, digest, inParallel, percentile, sleep } from '../support/http.mjs';
import { randomRequest } from './random_request.mjs';
import { memoryOf, probeHealth, randomFrom, rounded, startSubject } from './subject.mjs';

const HOUR = 36_000;
const QUICK = 1_200;
const CLIENTS = 6;
const KEPT = 300; // requests that are asked again at the end
// Room for the largest explicit mesh of a bundled scene with some others in use; what waits for room is asked again.
const CACHE_MEGABYTES = 64;
const MOST_TRIES = 100;
// What memory may grow by, from the mean over the fourth to sixth tenth of the requests to that over the last three: the
// cache of prepared scenes is full by then and has its own bound, so that growth is a leak, or the noise of the allocator
// and of what is being rendered at the moment. A leak of 3 kB a request shows in an hour's requests, one of 200 kB, as of
// a tile or a rounding, in a quick run, which is still warming up.
const GROWTH_MEGABYTES = { hour: 48, quick: 96 };

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
    let answer = await ask(url + request.path, { ...request, agent });
    for (let tries = 1; answer.status === 503 && answer.headers['retry-after'] && tries < MOST_TRIES; ++tries) {
      await sleep(50);
      answer = await ask(url + request.path, { ...request, agent });
    }
    assert.equal(answer.status, 200, `${request.method} ${request.path} ${request.body ?? ''}: ${answer.body}`);
    return answer;
  };
  const kept = [];
  const keepEvery = Math.ceil(requests.length / KEPT);
  const memory = []; // after each tenth of the requests
  try {
    const health = probeHealth(server.url, 200);
    const times = [];
    const began = performance.now();
    await inParallel(requests, CLIENTS, async (request, i) => {
      const { ms, body } = await fetchAnswer(server.url, request);
      times.push(ms);
      if (i % keepEvery === 0) kept.push({ request, digest: digest(body) });
      if (times.length % (requests.length / 10) === 0) memory.push(memoryOf(server.pid).now);
    });
    const seconds = (performance.now() - began) / 1000;
    const mean = (from, to) => memory.slice(from, to).reduce((sum, value) => sum + value, 0) / (to - from);
    const growth = mean(7, 10) - mean(3, 6);
    const { most } = memoryOf(server.pid);
    const { prepared_scenes: cache } = await askJson(`${server.url}/v1/info`);
    const livez = await health.end();

    for (const { request, digest: before } of kept)
      assert.equal(digest((await fetchAnswer(server.url, request)).body), before, request.path);
    if (!settings.instrumented)
      assert.ok(
        growth <= GROWTH_MEGABYTES[settings.quick ? 'quick' : 'hour'],
        `${growth} MB more at the end, ${memory} MB after each tenth of the requests`,
      );
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
      memoryMegabytes: { tenths: memory, growth: rounded(growth), most },
      cache: { builds: cache.builds, hits: cache.hits, megabytes: rounded(cache.bytes / 1048576) },
      livez,
      livezAfter: rounded(alive),
    };
  } finally {
    agent.destroy();
    await server.kill();
  }
}
