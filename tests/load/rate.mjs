// Small tiles, one after the other and several at a time: how many a second, and how long each takes.
import assert from 'node:assert/strict';
import http from 'node:http';

import { ask, inParallel, percentile } from '../support/http.mjs';
import { rounded, startSubject } from './subject.mjs';

export async function rate(settings) {
  const server = await startSubject(settings, ['--threads', '1']);
  try {
    const measure = async (width, url, count) => {
      const agent = new http.Agent({ keepAlive: true });
      const began = performance.now();
      const answers = await inParallel(Array.from({ length: count }), width, (_, i) => ask(url(i), { agent }));
      const seconds = (performance.now() - began) / 1000;
      agent.destroy();
      assert.ok(answers.every(({ status }) => status === 200));
      const times = answers.map(({ ms }) => ms);
      return {
        perSecond: rounded(count / seconds),
        p50: rounded(percentile(times, 0.5)),
        p99: rounded(percentile(times, 0.99)),
      };
    };
    const count = settings.quick ? 200 : 4000;
    const tile = (size, samples) => (i) =>
      server.tile(`512x512/${(i * size) % 512},${(Math.floor((i * size) / 512) * size) % 512},${size},${size}/0-${samples}.f16`);
    const figures = {};
    for (const width of [1, 4]) {
      figures[`tiles32x32x1at${width}`] = await measure(width, tile(32, 1), count);
      figures[`tiles64x64x4at${width}`] = await measure(width, tile(64, 4), Math.ceil(count / 4));
    }
    figures.livezAt4 = await measure(4, () => `${server.url}/livez`, count);
    await server.assertHealthy();
    return figures;
  } finally {
    await server.stop();
  }
}
