// The part of the address after '#': scene, camera, radius and rounding, so that a view can be shared as a link.

export const ROUNDINGS = ['analytic', 'none'];

const numberText = (x) => String(Number(x.toPrecision(6)));

/** Nine numbers and the field of view: eye, target, up, vertical degrees. The server's `camera=` takes the same text. */
export function cameraText({ eye, target, up, vfovDegrees }) {
  return [...eye, ...target, ...up, vfovDegrees].map(numberText).join(',');
}

/** The camera of cameraText(), or null where the text does not describe one. */
export function parseCamera(text) {
  const numbers = text.split(',').map((word) => (word.trim() === '' ? NaN : Number(word)));
  if (numbers.length !== 10 || !numbers.every(Number.isFinite)) return null;
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
  return camera;
}

/** Text for the address. `camera` and `radius` are left out where they are null: the scene's own. */
export function encodeView({ scene, camera, radius, rounding }) {
  const parts = [`scene=${encodeURIComponent(scene)}`];
  if (camera) parts.push(`camera=${cameraText(camera)}`);
  if (radius !== null) parts.push(`radius=${numberText(radius)}`);
  if (rounding !== 'analytic') parts.push(`rounding=${rounding}`);
  return `#${parts.join('&')}`;
}

/** What a link asks for; whatever it leaves out or has wrong is null (rounding: analytic). */
export function decodeView(hash) {
  const parameters = new URLSearchParams(hash.replace(/^#/, ''));
  const radius = Number(parameters.get('radius'));
  const rounding = parameters.get('rounding');
  return {
    scene: parameters.get('scene'),
    camera: parseCamera(parameters.get('camera') ?? ''),
    radius: Number.isFinite(radius) && radius > 0 ? radius : null,
    rounding: ROUNDINGS.includes(rounding) ? rounding : 'analytic',
  };
}
