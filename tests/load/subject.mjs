// The server under test, with what every part asks of it: its queue, its memory, its health.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';

import { ask, askJson, digest, percentile, sleep } from '../support/http.mjs';
import { startServer } from '../support/server.mjs';

const HEALTH_PATIENCE_MS = 5_000;

/** Starts chamferd with `options` and takes one tile as the truth for later. */
export async function startSubject({ chamferd, root }, options) {
  const server = await startServer(chamferd, root, 0, ['--log-level', 'error', ...options]);
  const { id } = await askJson(`${server.url}/v1/scenes/blocks`);
  const tile = (rest) => `${server.url}/v1/scenes/${id}/tiles/${rest}`;
  const witness = tile('256x256/96,96,32,32/0-2.f16');
  const truth = digest((await ask(witness)).body);

  const queue = async () => (await askJson(`${server.url}/v1/info`)).queue;
  /** Resolves to the milliseconds until nothing is rendered and nothing waits. */
  const untilIdle = async (patience) => {
    const began = performance.now();
    for (;;) {
      const { running, waiting } = await queue();
      const ms = performance.now() - began;
      if (running === 0 && waiting === 0) return ms;
      assert.ok(ms < patience, `${running} running and ${waiting} waiting after ${patience} ms`);
      await sleep(5);
    }
  };
  /** Alive at once, every slot free, and the same pixels as at the start. */
  const assertHealthy = async () => {
    const live = await ask(`${server.url}/livez`, { patience: HEALTH_PATIENCE_MS });
    assert.equal(live.status, 200);
    await untilIdle(HEALTH_PATIENCE_MS);
    const { status, body } = await ask(witness);
    assert.equal(status, 200);
    assert.equal(digest(body), truth, 'the tile from before');
    return live.ms;
  };
  const stop = async () => assert.equal(await server.stop(), 0, 'exit status');
  return { ...server, id, tile, queue, untilIdle, assertHealthy, stop };
}

/** Resident memory of a process in megabytes: now, and the most so far. */
export function memoryOf(pid) {
  const status = readFileSync(`/proc/${pid}/status`, 'utf8');
  const megabytes = (name) => Number(status.match(new RegExp(`${name}:\\s+(\\d+) kB`))[1]) / 1024;
  return { now: Math.round(megabytes('VmRSS')), most: Math.round(megabytes('VmHWM')) };
}

/** Asks for /livez again and again, each time on a new connection; `end()` stops it and tells how long it took. */
export function probeHealth(url, pause = 50) {
  const times = [];
  let ended = false;
  const probing = (async () => {
    while (!ended) {
      const { status, ms } = await ask(`${url}/livez`, { agent: false, patience: HEALTH_PATIENCE_MS });
      assert.equal(status, 200);
      times.push(ms);
      await sleep(pause);
    }
  })();
  return {
    async end() {
      ended = true;
      await probing;
      return { probes: times.length, p99: rounded(percentile(times, 0.99)), most: rounded(Math.max(...times)) };
    },
  };
}

export function rounded(value) {
  return Math.round(value * 10) / 10;
}

/** Random numbers in [0, 1) that a seed repeats (mulberry32, T. Ettinger, public domain). */
export function randomFrom(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
