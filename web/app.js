// The page: joins the address, the panel, the input on the picture, and the renderer. One state object says what is
// shown; everything else follows from it.
import { fetchHit, fetchScenes, fetchUpright, ServerError } from './api.js';
import { distance, fitAspect, isInside, keepInside, orbit, pan, pixelRay, zoom } from './camera.js';
import { Comparison } from './comparison.js';
import { HeatMap } from './heat_map.js';
import { listen } from './input.js';
import { JobPanel } from './job_panel.js';
import { rememberKey } from './key.js';
import { offerDownload, Panel } from './panel.js';
import { RadiusScale } from './radius.js';
import { seenPicture } from './painter.js';
import { Renderer } from './renderer.js';
import { Retry } from './retry.js';
import { decodeView, encodeView } from './viewstate.js';
import { retryText } from './words.js';

const SAMPLES = 256;
const LARGEST_PICTURE = 1_100_000; // pixels; more would only make the first picture late
const RELOAD_MS = 1000; // while scenes are loading, or the server is away
const REFRESH_MS = 5000; // else
const NO_SCENES = 'The server has no scenes: it found neither meshes with sidecars nor scene files.';
const ROOM_MARGIN = 0.03;
const DESIGNED_ASPECT = 4 / 3;
const ZOOM_RANGE = [0.02, 20]; // of the distance with which a scene starts

const canvas = document.getElementById('picture');
const otherCanvas = document.getElementById('picture-b');
const heatCanvas = document.getElementById('heat-map');
const heatMap = new HeatMap(heatCanvas, (top, isKnown) => comparison.showScale(top, isKnown));
const renderer = new Renderer([canvas, otherCanvas], heatMap, { total: SAMPLES, onStatus: showStatus });
const panel = new Panel({ scene: pickScene, up: setUp, rounding: setRounding, radius: moveRadius, resetRadius, resetCamera });

const comparison = new Comparison({ changed: comparisonChanged, moved: writeAddress, swapped, main: () => state, load: loadOther });
const jobPanel = new JobPanel(() => ({ sides: sides(), frame: frame() }), sayProblem);

const state = {
  scenes: [],
  scene: null, // details of the one that is shown
  camera: null,
  radius: null, // null: the scene's own
  rounding: 'analytic',
  up: null, // axis of bare meshes that points up; null: the server's choice
  scale: null, // RadiusScale, null where nothing is rounded
  ownHash: '', // the address as this page wrote it
  inspection: new AbortController(),
  picked: null, // name of the scene that is to be shown next, until it has come
  picking: new AbortController(),
};

// ---- scenes

let refreshTimer = 0;
let refreshes = 0;

/** Asks for the list of scenes, now and from then on: what is new appears, what has changed is taken up. */
async function refresh() {
  clearTimeout(refreshTimer);
  const turn = ++refreshes;
  let scenes;
  try {
    scenes = await fetchScenes();
  } catch (error) {
    if (turn !== refreshes) return;
    if (!state.scene || error.needsKey) sayProblem(error); // the picture says itself when the server is away
    if (!error.needsKey) refreshTimer = setTimeout(refresh, RELOAD_MS);
    return;
  }
  if (turn !== refreshes) return; // a later answer has come
  const loading = scenes.some((scene) => scene.state === 'loading');
  if (!document.hidden) refreshTimer = setTimeout(refresh, loading ? RELOAD_MS : REFRESH_MS);
  takeScenes(scenes);
}

function takeScenes(scenes) {
  const shown = state.scene?.name;
  const wasListed = state.scenes.some((scene) => scene.name === shown);
  state.scenes = scenes;
  panel.listScenes(scenes, state.picked ?? shown ?? '');
  comparison.refresh(scenes);
  if (state.picked) return;
  if (!state.scene) {
    panel.showProblem(scenes.length > 0 ? '' : NO_SCENES);
    followAddress();
    return;
  }
  const now = scenes.find((scene) => scene.name === shown);
  if (!now && wasListed) panel.showProblem(`“${shown}” is no longer on the server; the picture is the last of it.`);
  // A scene whose files have changed has another id.
  if (!now || !isReady(now) || now.id === state.scene.listedId) return;
  showScene(now, () => {
    const camera = state.camera === state.scene.camera ? null : state.camera;
    return { camera, radius: state.radius };
  });
}

const isReady = ({ state: word = 'ready' }) => word === 'ready';

/** Shows what the address asks for; without a scene in it, the first that can be shown. */
async function followAddress() {
  const wanted = decodeView(location.hash);
  const listed = state.scenes.find((scene) => scene.name === wanted.scene);
  if (listed?.state === 'loading') return; // refresh() comes back to it
  const fault = wanted.scene === null ? '' : faultOf(listed, wanted.scene);
  const chosen = fault || !listed ? firstScene() : listed;
  state.up = chosen === listed ? wanted.up : null;
  otherFault = null;
  const following = comparison.follow(chosen === listed ? wanted.compare : null, chosen?.name);
  const before = state.rounding; // whoever chooses another meanwhile gets that
  const view = () => ({
    ...(chosen === listed ? wanted : {}),
    rounding: state.rounding === before ? wanted.rounding : state.rounding,
  });
  const overtaken = chosen && !(await showScene(chosen, view));
  if (fault && !overtaken) panel.showProblem(fault);
  if (await following) comparisonChanged();
  else if (otherFault && !overtaken) sayProblem(otherFault);
}

function faultOf(listed, name) {
  if (!listed) return `The server has no scene “${name}”.`;
  return isReady(listed) ? '' : `“${name}” cannot be shown: ${listed.error?.detail ?? listed.state}`;
}

/** Scene files before single meshes, which lie in folders. */
function firstScene() {
  const ready = state.scenes.filter(isReady);
  return ready.find((scene) => !scene.name.includes('/')) ?? ready[0];
}

/**
 * Shows a scene, a bare mesh with the axis state.up up, once it has come, unless another was picked meanwhile; true: it is shown. `view()` is asked then, so that
 * it knows what was done in the meantime: {camera, radius}, null for the scene's own, and rounding.
 */
async function showScene(listed, view) {
  state.picking.abort();
  const { signal } = (state.picking = new AbortController());
  state.picked = listed.name;
  let scene;
  try {
    scene = await insist(() => fetchUpright(listed.name, state.up, signal), signal);
  } catch (error) {
    if (signal.aborted) return false;
    state.picked = null;
    if (state.scene) panel.showScene(state.scene);
    sayProblem(error);
    return false;
  }
  if (signal.aborted) return false;
  state.picked = null;
  const { camera = null, radius = null, rounding = state.rounding } = view();
  const { current, max } = scene.radius ?? {}; // null where nothing is rounded
  const room = scene.bounds && isInside(scene.camera, scene.bounds) ? scene.bounds : null;
  Object.assign(state, { scene, rounding, room, radius, camera: camera ?? scene.camera });
  state.scale = max > 0 ? new RadiusScale(max, current ?? 0) : null;
  if (!state.scale) state.radius = null;
  if (state.radius !== null) state.radius = Math.min(state.radius, state.scale.top);
  panel.showScene(scene);
  changed();
  return true;
}

function pickScene(name) {
  const listed = state.scenes.find((scene) => scene.name === name);
  if (!listed) return;
  showScene(listed, () => {
    comparison.forgetRadius();
    return {};
  });
}

/** Turns a bare mesh over; where it stands otherwise, it is looked at anew. */
function setUp(axis) {
  const radius = state.picked ? null : state.radius;
  const listed = state.scenes.find((scene) => scene.name === (state.picked ?? state.scene.name));
  if (!listed) return panel.showScene(state.scene);
  state.up = axis;
  showScene(listed, () => ({ radius }));
  comparison.refresh(state.scenes, { isTurned: true });
}

// ---- the view

function view() {
  return { sceneId: state.scene.id, camera: shownCamera(), rounding: state.rounding, radius: state.radius };
}

/** What is on the canvases: A alone or with B, each {scene, view}. */
function sides() {
  const a = { scene: state.scene, view: view() };
  return comparison.isOn ? [a, comparison.sideOf(a)] : [a];
}

const frame = () => ({ width: canvas.width, height: canvas.height });

/** The camera as it fits the picture's shape: scenes are made to be seen in the designed one, or a wider. */
function shownCamera() {
  return fitAspect(state.camera, canvas.width / canvas.height, DESIGNED_ASPECT);
}

function changed({ moving = false } = {}) {
  const own = state.radius === null;
  const radius = own ? (state.scene.radius?.current ?? 0) : state.radius;
  panel.showRounding(state.rounding, state.scale !== null);
  panel.showRadius(state.scale, radius, { own, enabled: state.scale !== null && state.rounding !== 'none' });
  comparison.show();
  fitCanvases();
  if (comparison.isOn) jobPanel.show(frame());
  forgetPoint();
  panel.showProblem('');
  showPicture({ moving });
  writeAddress();
}

function showPicture({ moving = false } = {}) {
  const views = sides().map((side) => side.view);
  renderer.show(views, { moving, difference: comparison.showsDifference });
}

function comparisonChanged(how) {
  if (state.scene) changed(how);
}

let otherFault = null;

/** A scene for the other side; null when there is none of it. */
async function loadOther(name, signal) {
  try {
    return await insist(() => fetchUpright(name, state.up, signal), signal);
  } catch (error) {
    if (signal.aborted) return null;
    otherFault = error.status === 404 ? new ServerError(`The server has no scene “${name}” for B.`, error) : error;
    sayProblem(otherFault);
    return null;
  }
}

/** What was B is A now. */
function swapped({ scene, rounding, radius }) {
  const other = scene ?? state.scene;
  const { current, max } = other.radius ?? {};
  const camera = state.camera; // of both
  Object.assign(state, { scene: other, rounding, radius, camera });
  state.scale = max > 0 ? new RadiusScale(max, current ?? 0) : null;
  panel.showScene(other);
  changed();
}

function moveCamera(camera) {
  if (!state.scene) return;
  state.camera = state.room ? keepInside(camera, state.room, ROOM_MARGIN) : camera;
  changed({ moving: true });
}

function zoomBy(factor) {
  const [nearest, farthest] = ZOOM_RANGE.map((share) => share * distance(state.scene.camera));
  moveCamera(zoom(state.camera, factor, nearest, farthest));
}

function setRounding(word) {
  state.rounding = word;
  changed();
}

function moveRadius(position, { final }) {
  state.radius = state.scale.radiusAt(position);
  changed({ moving: !final });
}

function resetRadius() {
  state.radius = null;
  changed();
}

function resetCamera() {
  state.camera = state.scene.camera;
  changed();
}

// ---- the address

let addressTimer = 0;
function writeAddress() {
  clearTimeout(addressTimer);
  addressTimer = setTimeout(() => {
    const camera = state.camera === state.scene.camera ? null : state.camera;
    const { scene, radius, rounding } = state;
    const up = scene.id === scene.listedId ? null : scene.up_axis.current;
    state.ownHash = encodeView({ scene: scene.name, camera, radius, rounding, up, compare: comparison.link() });
    history.replaceState(null, '', state.ownHash);
  }, 150);
}

addEventListener('hashchange', () => {
  if (location.hash !== state.ownHash && state.scenes.length > 0) followAddress();
});

// ---- the point under the pointer

/** `at`: the canvas, x and y: in its pixels on the page. */
async function inspect(x, y, at = canvas) {
  if (!state.scene) return;
  state.inspection.abort();
  const { signal } = (state.inspection = new AbortController());
  const { clientWidth: width, clientHeight: height } = at;
  const isOther = at === otherCanvas || (comparison.mode === 'slider' && x > (comparison.split / 100) * width);
  const side = sides()[isOther ? 1 : 0].view;
  try {
    const ray = pixelRay(side.camera, width, height, x, y);
    const hit = await insist(() => fetchHit(side, ray, signal), signal);
    if (!signal.aborted) panel.showPoint(hit, x + at.offsetLeft, y + at.offsetTop);
  } catch (error) {
    if (error.name !== 'AbortError') sayProblem(error);
  }
}

function forgetPoint() {
  state.inspection.abort();
  panel.showPoint(undefined);
}

// ---- what goes wrong, what goes on

function sayProblem(error) {
  if (!(error instanceof ServerError)) throw error;
  if (error.needsKey) askKey(error);
  else panel.showProblem(error.message);
}

function askKey({ status }) {
  panel.askKey(status === 403 ? 'That key is not one of this server’s.' : 'It is kept for this tab only.', (key) => {
    rememberKey(key);
    if (state.scene) changed();
    refresh();
  });
}

function showStatus(status) {
  panel.showStatus(status);
  if (status.phase === 'failed') refresh(); // the scene may have another id by now
}

/** Asks until there is an answer, and says so while there is none. */
async function insist(request, signal) {
  let told = false;
  const retry = new Retry((seconds, error) => {
    told = true;
    panel.showProblem(retryText(error, seconds));
  });
  const answer = await retry.run(request, signal);
  if (told && !signal.aborted) panel.showProblem('');
  return answer;
}

/** Gives the canvases as many pixels as they have room for; true: their number has changed. */
function fitCanvases() {
  const { clientWidth, clientHeight } = canvas;
  const wanted = Math.min(devicePixelRatio || 1, 2);
  const density = Math.min(wanted, Math.sqrt(LARGEST_PICTURE / Math.max(1, clientWidth * clientHeight)));
  const [width, height] = [clientWidth, clientHeight].map((side) => Math.max(16, Math.round(side * density)));
  return renderer.resize(width, height);
}

function fit() {
  if (!fitCanvases() || !state.scene) return;
  forgetPoint();
  if (comparison.isOn) jobPanel.show(frame());
  showPicture();
}

let fitTimer = 0;
new ResizeObserver(() => {
  clearTimeout(fitTimer);
  fitTimer = setTimeout(fit, 120);
}).observe(canvas.parentElement);

document.addEventListener('visibilitychange', () => {
  if (document.hidden) {
    renderer.pause();
    clearTimeout(refreshTimer);
  } else {
    renderer.resume();
    refresh();
  }
});

for (const element of [canvas, otherCanvas]) {
  listen(element, {
    turn: (azimuth, elevation) => state.camera && moveCamera(orbit(state.camera, azimuth, elevation)),
    shift: (dx, dy) => state.camera && moveCamera(pan(state.camera, dx, dy)),
    zoom: (factor) => state.camera && zoomBy(factor),
    inspect: (x, y) => inspect(x, y, element),
    home: () => state.camera && resetCamera(),
  });
}
offerDownload(
  document.getElementById('download'),
  () => seenPicture(comparison, { a: canvas, b: otherCanvas, difference: heatCanvas }),
  () => {
    const words = [state.scene?.name ?? 'scene', state.rounding];
    if (comparison.isOn) words.push(comparison.mode);
    return `${words.join('-').replaceAll(/[/:]/g, '-')}.png`;
  },
);
fit();
refresh();
