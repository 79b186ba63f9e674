// HAProxy and nginx as child processes, with the configurations that are shipped: only addresses, users and folders are
// replaced, so that they run unprivileged and beside others.
import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { sleep } from '../support/http.mjs';

const DEPLOY = new URL('../../server/deploy/', import.meta.url);
const START_MS = 20_000;
const STOP_MS = 10_000;
const ATTEMPTS = 5;

/**
 * The shipped haproxy.cfg for `nodes` (ports on this machine), listening on `port`. The file must have as many servers as
 * there are nodes.
 */
function haproxyConfig(nodes, port) {
  let text = readFileSync(new URL('haproxy.cfg', DEPLOY), 'utf8');
  text = replaced(text, /^ {4}(user|group) haproxy\n/gm, '', 2);
  text = replaced(text, /bind :8000$/gm, `bind 127.0.0.1:${port}`, 1);
  return replaced(text, /192\.0\.2\.(\d):8080/g, (_, n) => `127.0.0.1:${nodes[n - 1]}`, 2 * nodes.length);
}

/** The shipped site with what Debian's nginx.conf has around it; every file below `folder`. */
function nginxConfig(upstream, port, folder) {
  let site = readFileSync(new URL('nginx.conf', DEPLOY), 'utf8');
  site = replaced(site, /192\.0\.2\.1:8000/g, `127.0.0.1:${upstream}`, 1);
  site = replaced(site, /listen 80;/g, `listen 127.0.0.1:${port};`, 1);
  site = replaced(site, /\/var\/cache\/nginx\/chamfer/g, join(folder, 'cache'), 1);
  const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map(
    (name) => `${name}_temp_path ${join(folder, name)};`,
  );
  return `daemon off;\nmaster_process off;\npid ${join(folder, 'pid')};\nerror_log stderr warn;\nevents {}
http {\naccess_log off;\n${temporary.join('\n')}\n${site}}\n`;
}

function replaced(text, pattern, by, times) {
  const found = text.match(pattern)?.length ?? 0;
  if (found !== times) throw new Error(`${pattern} stands ${found} times in the shipped file, not ${times}`);
  return text.replace(pattern, by);
}

/** HAProxy before `nodes`. Resolves once it answers; `log()` is what it logged, a line a request. */
export function startHaproxy(nodes) {
  return start('haproxy', 'haproxy', ['-db', '-f'], (port) => haproxyConfig(nodes, port));
}

/** nginx before the port `upstream`. */
export function startNginx(upstream) {
  return start('nginx', 'nginx-light', ['-e', 'stderr', '-c'], (port, folder) => nginxConfig(upstream, port, folder));
}

async function start(program, debianPackage, words, configuration) {
  const folder = mkdtempSync(join(tmpdir(), `chamfer-${program}-`));
  mkdirSync(join(folder, 'cache'));
  const file = join(folder, `${program}.conf`);
  // Neither can tell a port that it chose itself, and a port that is free now may be taken a moment later.
  for (let attempt = 1; ; ++attempt) {
    const port = await freePort();
    writeFileSync(file, configuration(port, folder));
    const child = spawn(program, [...words, file], {
      stdio: ['ignore', 'pipe', 'pipe'],
      env: { ...process.env, PATH: `${process.env.PATH}:/usr/sbin` },
    });
    let output = '';
    for (const stream of [child.stdout, child.stderr]) stream.setEncoding('utf8').on('data', (text) => (output += text));
    const ended = new Promise((resolve) => {
      child.once('close', () => resolve('ended'));
      child.once('error', () => resolve('missing'));
    });
    const outcome = await Promise.race([ended, listening(port)]);
    if (outcome === 'listening') {
      const stop = async () => {
        child.kill('SIGTERM');
        const timer = setTimeout(() => child.kill('SIGKILL'), STOP_MS);
        await ended;
        clearTimeout(timer);
        rmSync(folder, { recursive: true, force: true });
      };
      return { url: `http://127.0.0.1:${port}`, port, log: () => output, stop };
    }
    child.kill('SIGKILL');
    if (outcome === 'missing' || attempt === ATTEMPTS) {
      rmSync(folder, { recursive: true, force: true });
      throw new Error(`${program} does not run (Debian package ${debianPackage}): ${output}`);
    }
  }
}

function freePort() {
  return new Promise((resolve, reject) => {
    const probe = net.createServer().once('error', reject);
    probe.listen(0, '127.0.0.1', () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

/** 'listening' once the port takes connections. */
async function listening(port) {
  for (const began = Date.now(); Date.now() - began < START_MS; await sleep(25)) {
    const open = await new Promise((resolve) => {
      const probe = net.connect(port, '127.0.0.1', () => resolve(true)).once('error', () => resolve(false));
      probe.once('connect', () => probe.destroy());
    });
    if (open) return 'listening';
  }
  return 'silent';
}
