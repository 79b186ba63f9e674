// 50 clients that go away at random: slots are freed within a second, and none is lost.
import assert from 'node:assert/strict';

import { ask, inParallel, percentile, sleep } from '../support/http.mjs';
import { probeHealth, randomFrom, rounded, startSubject } from './subject.mjs';

const CLIENTS = 50;
const LONGEST_WAIT_MS = 400;
const FREED_WITHIN_MS = 1_000; // what the service promises

export async function cancels(settings) {
  const server = await startSubject(settings, ['--threads', '1', '--waiting', '64']);
  const random = randomFrom(settings.seed);
  const minutesLong = (i) => server.tile(`4096x4096/${i % 1024},${i % 1024},1024,1024/0-1024.f16`);
  const short = (i) => server.tile(`256x256/${i % 224},64,32,32/0-1.f16`);
  try {
    // One at a time: how long until its slot is free?
    const freed = [];
    for (let i = 0; i < (settings.quick ? 8 : 50); ++i) {
      let leave;
      const answer = ask(minutesLong(i), { cancel: (f) => (leave = f) }).catch(() => 'left');
      while ((await server.queue()).running === 0) await sleep(2);
      await sleep(LONGEST_WAIT_MS * random());
      leave();
      freed.push(await server.untilIdle(FREED_WITHIN_MS));
      assert.equal(await answer, 'left');
    }

    // All at once: renders, places in the queue, half-read answers.
    const health = probeHealth(server.url);
    let left = 0;
    let answered = 0;
    await inParallel(Array.from({ length: CLIENTS }), CLIENTS, async (_, client) => {
      for (let round = 0; round < (settings.quick ? 6 : 60); ++round) {
        let leave;
        const url = random() < 0.5 ? minutesLong(client) : short(client);
        const answer = ask(url, { agent: false, cancel: (f) => (leave = f) });
        const timer = setTimeout(() => leave(), LONGEST_WAIT_MS * random());
        try {
          const { status, headers } = await answer;
          assert.ok(status === 200 || (status === 503 && headers['retry-after'] >= 1), `status ${status}`);
          ++answered;
        } catch (error) {
          if (error.message !== 'cancelled') throw error;
          ++left;
        }
        clearTimeout(timer);
      }
    });
    const idleAfter = await server.untilIdle(FREED_WITHIN_MS);
    const livez = await health.end();
    const alive = await server.assertHealthy();
    return {
      cancelsTimed: freed.length,
      freedP50: rounded(percentile(freed, 0.5)),
      freedMost: rounded(Math.max(...freed)),
      storm: { left, answered, idleAfter: rounded(idleAfter) },
      livez,
      livezAfter: rounded(alive),
    };
  } finally {
    await server.stop();
  }
}
