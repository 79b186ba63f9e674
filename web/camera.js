// The camera and how it is moved. Pure functions: a camera {eye, target, up, vfovDegrees} in, another one out. World
// coordinates, right-handed; `up` need not be orthogonal to the view, and never changes.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scale(a, 1 / length(a));

/** How near to straight up or down a view may turn. */
const POLE_MARGIN = (1 * Math.PI) / 180;

/** Unit vectors of the view: `forward` into the picture, `right` and `up` along it. */
export function basis(camera) {
  const forward = unit(sub(camera.target, camera.eye));
  const right = unit(cross(forward, camera.up));
  return { forward, right, up: cross(right, forward) };
}

function rotate(v, axis, angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
}

/** Turns the eye about the target: `azimuth` about the up axis, `elevation` upwards (radians), short of the poles. */
export function orbit(camera, azimuth, elevation) {
  const axis = unit(camera.up);
  const arm = rotate(sub(camera.eye, camera.target), axis, azimuth);
  const now = Math.asin(Math.max(-1, Math.min(1, dot(unit(arm), axis))));
  const limit = Math.PI / 2 - POLE_MARGIN;
  const next = Math.max(-limit, Math.min(limit, now + elevation));
  const level = unit(sub(arm, scale(axis, dot(arm, axis))));
  const direction = add(scale(level, Math.cos(next)), scale(axis, Math.sin(next)));
  return { ...camera, eye: add(camera.target, scale(direction, length(arm))) };
}

/** Moves the eye along the view: the distance to the target is multiplied by `factor`, within [nearest, farthest]. */
export function zoom(camera, factor, nearest, farthest) {
  const arm = sub(camera.eye, camera.target);
  const distance = Math.max(nearest, Math.min(farthest, length(arm) * factor));
  return { ...camera, eye: add(camera.target, scale(unit(arm), distance)) };
}

/** Shifts eye and target so that what is at the target's distance moves by (dx, dy) shares of the picture's height. */
export function pan(camera, dx, dy) {
  const { right, up } = basis(camera);
  const height = 2 * distance(camera) * Math.tan((camera.vfovDegrees * Math.PI) / 360);
  const shift = add(scale(right, -dx * height), scale(up, dy * height));
  return { ...camera, eye: add(camera.eye, shift), target: add(camera.target, shift) };
}

export function distance(camera) {
  return length(sub(camera.eye, camera.target));
}

/** Is the eye inside the box `bounds` {min, max}? */
export function isInside(camera, bounds) {
  return camera.eye.every((x, i) => x > bounds.min[i] && x < bounds.max[i]);
}

/** For rooms seen from inside: draws the eye towards the target until it is `margin` (share of each side) inside. */
export function keepInside(camera, bounds, margin) {
  const arm = sub(camera.eye, camera.target);
  let share = 1;
  for (let i = 0; i < 3; i++) {
    const inset = (bounds.max[i] - bounds.min[i]) * margin;
    const [low, high] = [bounds.min[i] + inset, bounds.max[i] - inset];
    if (camera.target[i] <= low || camera.target[i] >= high) return camera;
    if (camera.eye[i] < low) share = Math.min(share, (low - camera.target[i]) / arm[i]);
    if (camera.eye[i] > high) share = Math.min(share, (high - camera.target[i]) / arm[i]);
  }
  return share === 1 ? camera : { ...camera, eye: add(camera.target, scale(arm, share)) };
}

/**
 * The camera for a picture of that aspect (width over height): where it is narrower than `designed`, the view widens so
 * that what is seen from left to right stays what it would be at `designed`.
 */
export function fitAspect(camera, aspect, designed) {
  if (aspect >= designed) return camera;
  const half = Math.tan((camera.vfovDegrees * Math.PI) / 360);
  return { ...camera, vfovDegrees: (Math.atan((half * designed) / aspect) * 360) / Math.PI };
}

/** The ray through the point (x, y) of a picture, in pixels from its top left; the direction is unit. */
export function pixelRay(camera, width, height, x, y) {
  const { forward, right, up } = basis(camera);
  const half = Math.tan((camera.vfovDegrees * Math.PI) / 360);
  const across = ((2 * x - width) / height) * half;
  const upward = ((height - 2 * y) / height) * half;
  return { origin: camera.eye, direction: unit(add(forward, add(scale(right, across), scale(up, upward)))) };
}
