// The real programs on a copy of the bundled data: chamferprep rounds it, chamferd serves it.
import { spawn, spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const START_MS = 60_000;
const STOP_MS = 15_000;

/**
 * Copies `data` to a temporary folder and rounds its solids and bricks. `scenes`, where given, are the only scene files
 * that are taken along. Returns the folder and how to remove it.
 */
export function makeRoot(chamferprep, data, scenes = undefined) {
  const root = mkdtempSync(join(tmpdir(), 'chamfer-test-'));
  const remove = () => rmSync(root, { recursive: true, force: true });
  const wanted = (source) =>
    !source.endsWith('.chamfer') && !(scenes && source.endsWith('.scene.json') && !scenes.includes(basename(source)));
  try {
    cpSync(data, root, { recursive: true, filter: wanted });
    for (const [folder, radius] of [['solids', '0.08'], ['bricks', '0.05']]) {
      roundMesh(chamferprep, readdirSync(join(root, folder)).map((name) => join(root, folder, name)), radius);
    }
  } catch (error) {
    remove();
    throw error;
  }
  return { root, remove };
}

/** Writes the sidecar of a mesh, or of a list of them. */
export function roundMesh(chamferprep, meshes, radius) {
  const run = spawnSync(chamferprep, [meshes, '--radius', radius, '-j', '1'].flat(), { encoding: 'utf8' });
  if (run.error) throw new Error(`cannot run ${chamferprep}: ${run.error.message}; build the target chamferprep`);
  if (run.status !== 0) throw new Error(`chamferprep on ${meshes} ended with ${run.status}: ${run.stderr}`);
}

/**
 * Starts chamferd on `root`; port 0 means any free one. Resolves once it is ready: every scene was tried. `options` are
 * further words of its command line.
 */
export async function startServer(chamferd, root, port = 0, options = []) {
  const words = ['serve', root, '--port', String(port), ...options];
  const child = spawn(chamferd, words, { stdio: ['ignore', 'pipe', 'pipe'] });
  let output = '';
  const ended = new Promise((resolve) => child.once('close', (status, signal) => resolve(status ?? signal)));
  const address = new Promise((resolve, reject) => {
    const listen = (chunk) => {
      output += chunk;
      const found = output.match(/http:\/\/[\w.]+:(\d+)/);
      if (!found) return;
      resolve({ url: found[0], port: Number(found[1]) });
      for (const stream of [child.stdout, child.stderr]) stream.off('data', listen).resume();
    };
    child.stdout.setEncoding('utf8').on('data', listen);
    child.stderr.setEncoding('utf8').on('data', listen);
    child.once('error', (cause) => reject(new Error(`cannot run ${chamferd}: ${cause.message}; build the target chamferd`)));
    ended.then((status) => reject(new Error(`chamferd ended with ${status}: ${output}`)));
    setTimeout(() => reject(new Error(`chamferd printed no address: ${output}`)), START_MS).unref();
  });
  /** Ends it as an operator would; resolves to its exit status. */
  const stop = async () => {
    child.kill('SIGTERM');
    const timer = setTimeout(() => child.kill('SIGKILL'), STOP_MS);
    const status = await ended;
    clearTimeout(timer);
    return status;
  };
  /** Ends it without warning. */
  const kill = async () => {
    child.kill('SIGKILL');
    return ended;
  };
  try {
    const { url, port: bound } = await address;
    await untilReady(url);
    return { url, port: bound, pid: child.pid, stop, kill };
  } catch (error) {
    child.kill('SIGKILL');
    throw error;
  }
}

async function untilReady(url) {
  for (const started = Date.now(); Date.now() - started < START_MS; ) {
    const { ok } = await fetch(`${url}/readyz`);
    if (ok) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error(`chamferd was not ready within ${START_MS / 1000} s`);
}
