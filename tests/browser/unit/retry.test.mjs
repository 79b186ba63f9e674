import assert from 'node:assert/strict';
import { test } from 'node:test';

import { Retry } from '../../../web/retry.js';

const fault = (change) => Object.assign(new Error('busy'), { passing: true, retryAfter: null }, change);

test('a passing fault is tried again after the time it asks for', async () => {
  const waits = [];
  let calls = 0;
  const retry = new Retry((seconds) => waits.push(seconds));
  const request = async () => {
    if (++calls < 3) throw fault({ retryAfter: 0.01 });
    return 'tile';
  };
  assert.equal(await retry.run(request, new AbortController().signal), 'tile');
  assert.deepEqual(waits, [0.01, 0.01]);
});

test('any other fault ends it at once', async () => {
  const retry = new Retry(() => assert.fail('must not wait'));
  const request = () => Promise.reject(fault({ passing: false }));
  await assert.rejects(retry.run(request, new AbortController().signal), /busy/);
});

test('without a time the pauses double, and stopping ends a pause', async () => {
  const waits = [];
  const abort = new AbortController();
  const retry = new Retry((seconds) => {
    waits.push(seconds);
    if (waits.length === 2) abort.abort();
  });
  const started = performance.now();
  await assert.rejects(retry.run(() => Promise.reject(fault()), abort.signal), { name: 'AbortError' });
  assert.deepEqual(waits, [1, 2]);
  assert.ok(performance.now() - started < 1900);
});
