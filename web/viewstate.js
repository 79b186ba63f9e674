// The part of the address after '#': scene, camera, radius, rounding and the axis that is up, so that a view can be shared as a link.

export const ROUNDINGS = ['analytic', 'none'];
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

/** Text for the address. `camera`, `radius` and `up` are left out where they are null: the scene's own. */
export function encodeView({ scene, camera, radius, rounding, up }) {
  const parts = [`scene=${encodeURIComponent(scene)}`];
  if (camera) parts.push(`camera=${cameraText(camera)}`);
  if (radius !== null) parts.push(`radius=${numberText(radius)}`);
  if (rounding !== 'analytic') parts.push(`rounding=${rounding}`);
  if (up !== null) parts.push(`up=${up}`);
  return `#${parts.join('&')}`;
}

/** What a link asks for; whatever it leaves out or has wrong is null (rounding: analytic). */
export function decodeView(hash) {
  const parameters = new URLSearchParams(hash.replace(/^#/, ''));
  const radius = Number(parameters.get('radius'));
  const rounding = parameters.get('rounding');
  const up = parameters.get('up');
  return {
    scene: parameters.get('scene'),
    camera: parseCamera(parameters.get('camera') ?? ''),
    radius: Number.isFinite(radius) && radius > 0 ? radius : null,
    rounding: ROUNDINGS.includes(rounding) ? rounding : 'analytic',
    up: UP_AXES.includes(up) ? up : null,
  };
}
