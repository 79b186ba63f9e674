// 240 connections: 100 of them fetch tiles, 50 send a head a byte a second, 40 promise large bodies and send them a byte a
// second, 50 say nothing at all.
import assert from 'node:assert/strict';
import http from 'node:http';
import net from 'node:net';

import { ask, digest, inParallel, percentile, sleep } from '../support/http.mjs';
import { probeHealth, rounded, startSubject } from './subject.mjs';

const HEALTHY = 100;
const SLOW = 50;
const BODIES = 40; // of 32 MiB each: five times what all bodies may have
const IDLE = 50;

/** Keeps `count` connections open, opening each anew when the server ends it; `onOpen(socket)` makes them a nuisance. */
function nuisances(port, count, onOpen) {
  const sockets = new Set();
  let ended = false;
  let opened = 0;
  const open = () => {
    if (ended) return;
    ++opened;
    const socket = net.connect(port, '127.0.0.1', () => onOpen(socket));
    sockets.add(socket);
    socket.on('error', () => {}).on('close', () => {
      sockets.delete(socket);
      open();
    });
    socket.resume();
  };
  for (let i = 0; i < count; ++i) open();
  return () => {
    ended = true;
    for (const socket of sockets) socket.destroy();
    return opened;
  };
}

function drip(socket) {
  const head = 'GET /v1/scenes HTTP/1.1\r\nHost: localhost\r\nX-Slow: yes\r\n\r\n';
  let sent = 0;
  const timer = setInterval(() => socket.write(head[sent++ % head.length]), 1_000);
  socket.on('close', () => clearInterval(timer));
}

function dripBody(socket) {
  const fields = 'Host: localhost\r\nContent-Type: application/json\r\nContent-Length: 33554432';
  socket.write(`POST /v1/scenes/blocks/rays HTTP/1.1\r\n${fields}\r\n\r\n`);
  const timer = setInterval(() => socket.write(' '), 1_000);
  socket.on('close', () => clearInterval(timer));
}

export async function slowClients(settings) {
  const server = await startSubject(settings, ['--threads', '1', '--waiting', '128']);
  const tiles = Array.from({ length: settings.quick ? 600 : 4000 }, (_, i) =>
    server.tile(`256x256/${(i % 8) * 32},${(Math.floor(i / 8) % 8) * 32},32,32/0-1.f16`),
  );
  const measure = async () => {
    const agent = new http.Agent({ keepAlive: true });
    const began = performance.now();
    const answers = await inParallel(tiles, HEALTHY, (url) => ask(url, { agent }));
    const seconds = (performance.now() - began) / 1000;
    agent.destroy();
    assert.ok(answers.every(({ status }) => status === 200));
    const times = answers.map(({ ms }) => ms);
    return {
      tilesPerSecond: rounded(tiles.length / seconds),
      p50: rounded(percentile(times, 0.5)),
      p99: rounded(percentile(times, 0.99)),
      digests: answers.map(({ body }) => digest(body)),
    };
  };
  try {
    const { digests, ...alone } = await measure();
    const endSlow = nuisances(server.port, SLOW, drip);
    const endBodies = nuisances(server.port, BODIES, dripBody);
    const endIdle = nuisances(server.port, IDLE, () => {});
    await sleep(settings.quick ? 500 : 20_000); // beyond the server's patience with either, where there is time
    const health = probeHealth(server.url);
    const { digests: again, ...beside } = await measure();
    const livez = await health.end();
    const batch = { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: '{"rays":[[0,0,9,0,0,-1]]}' };
    assert.equal((await ask(`${server.url}/v1/scenes/blocks/rays`, batch)).status, 200, 'a body beside those');
    const opened = endSlow() + endBodies() + endIdle();

    assert.deepEqual(again, digests);
    // A server that gave each connection a thread, or waited for one of them, would come to a stop; what remains is the
    // noise of the machine.
    assert.ok(beside.tilesPerSecond > alone.tilesPerSecond / 3, `${beside.tilesPerSecond} of ${alone.tilesPerSecond}`);
    const alive = await server.assertHealthy();
    return { alone, beside, livez, connectionsOpened: opened, livezAfter: rounded(alive) };
  } finally {
    await server.stop();
  }
}
