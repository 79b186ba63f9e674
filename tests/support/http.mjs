// HTTP as the load and farm tests need it: one request with its time, bodies as digests, percentiles, many at a time.
import { createHash } from 'node:crypto';
import http from 'node:http';

const PATIENCE_MS = 120_000;

/**
 * Sends one request and reads its answer to the end. Rejects when the connection fails, when the answer is cut short, and
 * after `patience` ms. `cancel`, if given, is called with a function that closes the connection.
 */
export function ask(url, { method = 'GET', headers, body, agent, localAddress, patience = PATIENCE_MS, cancel } = {}) {
  const began = performance.now();
  return new Promise((resolve, reject) => {
    const request = http.request(url, { method, headers, agent, localAddress });
    const timer = setTimeout(() => request.destroy(new Error(`no answer within ${patience} ms: ${url}`)), patience);
    const fail = (error) => {
      clearTimeout(timer);
      reject(error);
    };
    request.on('error', fail).on('response', (response) => {
      const chunks = [];
      response.on('data', (chunk) => chunks.push(chunk));
      response.on('error', fail); // "aborted": fewer bytes than Content-Length said
      response.on('end', () => {
        clearTimeout(timer);
        const ms = performance.now() - began;
        resolve({ status: response.statusCode, headers: response.headers, body: Buffer.concat(chunks), ms });
      });
    });
    cancel?.(() => request.destroy(new Error('cancelled')));
    request.end(body);
  });
}

/** The answer's JSON; any status but 200 is an error. */
export async function askJson(url, options) {
  const { status, body } = await ask(url, options);
  if (status !== 200) throw new Error(`${url} answers ${status}: ${body}`);
  return JSON.parse(body);
}

export function digest(bytes) {
  return createHash('sha256').update(bytes).digest('hex');
}

/** The smallest value that at least `share` (0..1) of `values` do not exceed. */
export function percentile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.max(0, Math.ceil(share * sorted.length) - 1)];
}

/** Runs `work(item, index)` for all items, `width` at a time; resolves to the results in the items' order. */
export async function inParallel(items, width, work) {
  const results = new Array(items.length);
  let next = 0;
  const worker = async () => {
    while (next < items.length) {
      const i = next++;
      results[i] = await work(items[i], i);
    }
  };
  await Promise.all(Array.from({ length: Math.min(width, items.length) }, worker));
  return results;
}

export function sleep(ms) {
  return new Promise((resolve) => setTimeout(resolve, ms));
}
