// The server's HTTP interface as the page uses it. Every call takes an AbortSignal and fails with a ServerError.
import { keyHeaders } from './key.js';
import { decodeTile } from './tiles.js';
import { settingsText } from './viewstate.js';

/** What went wrong, in words for the viewer. `status` 0: no answer, or not all of it. */
export class ServerError extends Error {
  constructor(message, { status = 0, retryAfter = null } = {}) {
    super(message);
    this.name = 'ServerError';
    this.status = status;
    /** Seconds after which the server asks to be tried again, or null. */
    this.retryAfter = retryAfter;
  }

  /** Worth trying again: busy, draining, unreachable, or cut short. */
  get passing() {
    return [0, 429, 502, 503, 504].includes(this.status);
  }

  /** The server wants a key, or another one. */
  get needsKey() {
    return [401, 403].includes(this.status);
  }
}

async function request(url, options) {
  let response;
  try {
    response = await fetch(url, { ...options, headers: { ...options?.headers, ...keyHeaders() } });
  } catch (cause) {
    if (cause.name === 'AbortError') throw cause;
    throw new ServerError('The server does not answer.');
  }
  if (response.ok) return response;
  throw await problemOf(response);
}

/** What `read` makes of the body; one that ends early or is no such thing is worth asking for again. */
async function bodyOf(response, read) {
  try {
    return await read(response);
  } catch (cause) {
    if (cause.name === 'AbortError') throw cause;
    throw new ServerError('An answer of the server was cut short.');
  }
}

async function problemOf(response) {
  let words = `The server answered ${response.status} ${response.statusText}`.trim();
  const text = await response.text().catch(() => '');
  try {
    const problem = JSON.parse(text);
    words = problem.detail ?? problem.title ?? words;
  } catch {
    // Not from chamferd (a proxy, perhaps): the status line has to do.
  }
  const seconds = Number(response.headers.get('Retry-After'));
  const retryAfter = response.headers.has('Retry-After') && Number.isFinite(seconds) ? seconds : null;
  return new ServerError(words, { status: response.status, retryAfter });
}

const readJson = (response) => bodyOf(response, (whole) => whole.json());
const getJson = async (url, signal) => readJson(await request(url, { signal }));

async function postJson(url, body, signal) {
  const headers = { 'Content-Type': 'application/json' };
  return readJson(await request(url, { method: 'POST', headers, body: JSON.stringify(body), signal }));
}

/** Version, limits, formats; `comparisons`: null where the server takes no jobs. */
export const fetchInfo = (signal) => getJson('v1/info', signal);

/** All scenes: [{name, id, triangles, rounded_edges, radius: {current, max}, state, error, ...}]. */
export const fetchScenes = (signal) => getJson('v1/scenes', signal);

/** One scene, by name as it is now or by id, its camera with the page's names: {..., camera: {eye, target, up, vfovDegrees, ...}}. */
export async function fetchScene(nameOrId, signal) {
  const scene = await getJson(`v1/scenes/${encodeURIComponent(nameOrId)}`, signal);
  const { eye, target, up, vfov_degrees, aperture_diameter, focus_distance } = scene.camera;
  const lens = { apertureDiameter: aperture_diameter, focusDistance: focus_distance };
  return { ...scene, camera: { eye, target, up, vfovDegrees: vfov_degrees, ...lens } };
}

/**
 * A scene as fetchScene() gives it, of a bare mesh with its `up` axis (y, z, or null: the server's choice) turned up;
 * and `listedId`, the id of the scene that goes by the name.
 */
export async function fetchUpright(name, up, signal) {
  const listed = await fetchScene(name, signal);
  const other = up && listed.up_axis && listed.up_axis.current !== up;
  return { ...(other ? await fetchScene(listed.up_axis.ids[up], signal) : listed), listedId: listed.id };
}

/**
 * Address of a tile, a pure function of its arguments. `view`: {sceneId, camera, rounding, radius}; `frame`: {width,
 * height}; `tile`: {x, y, width, height}; `range`: [first, end).
 */
export function tileUrl(view, frame, tile, [first, end]) {
  const rectangle = [tile.x, tile.y, tile.width, tile.height].join(',');
  const size = `${frame.width}x${frame.height}`;
  const scene = encodeURIComponent(view.sceneId);
  return `v1/scenes/${scene}/tiles/${size}/${rectangle}/${first}-${end}.f16?${settingsText(view)}`;
}

/** A tile's pixels, and how many of its rays hit anything and a rounding: {width, height, samples, rgba, rays, rounded}. */
export async function fetchTile(url, signal) {
  const response = await request(url, { signal });
  const count = (name) => Number(response.headers.get(name)) || 0;
  const tile = await bodyOf(response, async (whole) => decodeTile(await whole.arrayBuffer()));
  return { ...tile, rays: count('X-Chamfer-Rays'), rounded: count('X-Chamfer-Rounded') };
}

/** First hit of one ray with the scene's own instances, or null. `view` as in tileUrl(). */
export async function fetchHit(view, { origin, direction }, signal) {
  const body = { rays: [[...origin, ...direction]], rounding: view.rounding };
  if (view.radius !== null && view.rounding !== 'none') body.radius = view.radius;
  const found = await postJson(`v1/scenes/${encodeURIComponent(view.sceneId)}/rays`, body, signal);
  return found.hits[0] ?? null;
}

/** Submits a suite of cases; the job's state (data/COMPARISONS.md, "Over HTTP"). The same suite is the same job. */
export const startJob = (suite, signal) => postJson('v1/comparisons', suite, signal);

export const fetchJob = (id, signal) => getJson(`v1/comparisons/${id}`, signal);

/** Cancels a job that waits or runs. */
export async function cancelJob(id, signal) {
  await request(`v1/comparisons/${id}`, { method: 'DELETE', signal });
}

/** A job's report, a page in one file, as text. */
export async function fetchReport(id, signal) {
  return bodyOf(await request(reportUrl(id), { signal }), (whole) => whole.text());
}

export const reportUrl = (id) => `v1/comparisons/${id}/report.html`;
