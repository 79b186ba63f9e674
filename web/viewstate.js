// The part of the address after '#': scene, camera, radius, rounding, the axis that is up, and what it is compared with, so that
// a view can be shared as a link.
import { parseRounding } from './rounding.js';

export const MODES = ['slider', 'beside', 'difference'];
const UP_AXES = ['y', 'z'];

const numberText = (x) => String(Number(x.toPrecision(6)));

/**
 * Eye, target, up, vertical field of view in degrees and, for a thin lens, aperture diameter and focus distance. The
 * server's `camera=` takes the same text.
 */
export function cameraText({ eye, target, up, vfovDegrees, apertureDiameter = 0, focusDistance = 0 }) {
  const lens = apertureDiameter > 0 ? [apertureDiameter, focusDistance] : [];
  return [...eye, ...target, ...up, vfovDegrees, ...lens].map(numberText).join(',');
}

/** The camera of cameraText(), or null where the text does not describe one. */
export function parseCamera(text) {
  const numbers = text.split(',').map((word) => (word.trim() === '' ? NaN : Number(word)));
  if (![10, 12].includes(numbers.length) || !numbers.every(Number.isFinite)) return null;
  const camera = {
    eye: numbers.slice(0, 3),
    target: numbers.slice(3, 6),
    up: numbers.slice(6, 9),
    vfovDegrees: numbers[9],
  };
  const forward = camera.target.map((x, i) => x - camera.eye[i]);
  const crossed = [0, 1, 2].map(
    (i) => forward[(i + 1) % 3] * camera.up[(i + 2) % 3] - forward[(i + 2) % 3] * camera.up[(i + 1) % 3],
  );
  if (Math.hypot(...crossed) === 0 || !(camera.vfovDegrees > 0 && camera.vfovDegrees < 180)) return null;
  if (numbers.length === 10) return camera;
  const [apertureDiameter, focusDistance] = numbers.slice(10);
  return apertureDiameter >= 0 && focusDistance >= 0 ? { ...camera, apertureDiameter, focusDistance } : null;
}

/**
 * What makes a picture of a scene, in the server's parameters. `view`: {camera, rounding, radius}; radius null: the scene's own.
 */
export function settingsText({ camera, rounding, radius }) {
  const words = [`camera=${cameraText(camera)}`, `rounding=${rounding}`];
  if (radius !== null && rounding !== 'none') words.push(`radius=${numberText(radius)}`);
  return words.join('&');
}

/**
 * Text for the address. `camera`, `radius` and `up` are left out where they are null: the scene's own. `compare`: null, or
 * {mode, split, scene, rounding, radius} with the divider's place in per cent, and the scene null where both are of one.
 */
export function encodeView({ scene, camera, radius, rounding, up, compare }) {
  const parts = [`scene=${encodeURIComponent(scene)}`];
  if (camera) parts.push(`camera=${cameraText(camera)}`);
  if (radius !== null) parts.push(`radius=${numberText(radius)}`);
  if (rounding !== 'analytic') parts.push(`rounding=${rounding}`);
  if (up !== null) parts.push(`up=${up}`);
  if (!compare) return `#${parts.join('&')}`;
  parts.push(`compare=${compare.mode}`);
  if (compare.split !== 50) parts.push(`split=${numberText(compare.split)}`);
  if (compare.scene !== null) parts.push(`b-scene=${encodeURIComponent(compare.scene)}`);
  parts.push(`b-rounding=${compare.rounding}`);
  if (compare.radius !== null) parts.push(`b-radius=${numberText(compare.radius)}`);
  return `#${parts.join('&')}`;
}

/** What a link asks for; whatever it leaves out or has wrong is null (rounding: analytic). */
export function decodeView(hash) {
  const parameters = new URLSearchParams(hash.replace(/^#/, ''));
  const up = parameters.get('up');
  return {
    scene: parameters.get('scene'),
    camera: parseCamera(parameters.get('camera') ?? ''),
    radius: radiusOf(parameters.get('radius')),
    rounding: roundingOf(parameters.get('rounding')),
    up: UP_AXES.includes(up) ? up : null,
    compare: compareOf(parameters),
  };
}

function compareOf(parameters) {
  const mode = parameters.get('compare');
  if (!MODES.includes(mode)) return null;
  const split = Number(parameters.get('split') ?? NaN);
  return {
    mode,
    split: split >= 0 && split <= 100 ? split : 50,
    scene: parameters.get('b-scene'),
    rounding: roundingOf(parameters.get('b-rounding')),
    radius: radiusOf(parameters.get('b-radius')),
  };
}

const roundingOf = (word) => (parseRounding(word) ? word : 'analytic');

function radiusOf(text) {
  const radius = Number(text);
  return Number.isFinite(radius) && radius > 0 ? radius : null;
}
