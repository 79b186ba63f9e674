// More requests than the server has places for: each is answered, with its tile or with 503 and when to come back.
import assert from 'node:assert/strict';

import { ask, digest, inParallel, percentile, sleep } from '../support/http.mjs';
import { probeHealth, rounded, startSubject } from './subject.mjs';

const SLOTS = 2;
const WAITING = 8;

export async function overload(settings) {
  const server = await startSubject(settings, ['--threads', '1', '--slots', `${SLOTS}`, '--waiting', `${WAITING}`]);
  const requests = settings.quick ? 100 : 400;
  const urls = Array.from({ length: requests }, (_, i) => server.tile(`256x256/${(i % 4) * 64},96,64,64/0-8.f16`));
  try {
    const truth = [];
    for (const url of urls.slice(0, 4)) truth.push(digest((await ask(url)).body));
    const right = ({ status, body }, i) => {
      assert.equal(status, 200);
      assert.equal(digest(body), truth[i % 4]);
    };

    const health = probeHealth(server.url, 10);
    const refusedTimes = [];
    let served = 0;
    await inParallel(urls, requests, async (url, i) => {
      const answer = await ask(url, { agent: false });
      if (answer.status === 503) {
        assert.match(answer.headers['retry-after'], /^[1-9]\d*$/);
        refusedTimes.push(answer.ms);
      } else {
        right(answer, i);
        ++served;
      }
    });
    assert.ok(served >= SLOTS + WAITING, `${served} served`);
    assert.ok(refusedTimes.length > 0, 'there were more requests than places');

    // Clients that do as they are told are all served in the end.
    let repeats = 0;
    await inParallel(urls.slice(0, 60), 60, async (url, i) => {
      for (;;) {
        const answer = await ask(url, { agent: false });
        if (answer.status !== 503) return right(answer, i);
        ++repeats;
        await sleep(1000 * Number(answer.headers['retry-after']));
      }
    });
    const livez = await health.end();
    const alive = await server.assertHealthy();
    return {
      requests,
      served,
      refused: refusedTimes.length,
      refusedP99: rounded(percentile(refusedTimes, 0.99)),
      obedient: { served: 60, repeats },
      livez,
      livezAfter: rounded(alive),
    };
  } finally {
    await server.stop();
  }
}
