import assert from 'node:assert/strict';
import { test } from 'node:test';

import { basis, distance, fitAspect, isInside, keepInside, orbit, pan, pixelRay, zoom } from '../../../web/camera.js';

const camera = { eye: [3, -4, 2], target: [0.5, 0, 1], up: [0, 0, 1], vfovDegrees: 40 };
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const near = (a, b, tolerance = 1e-9) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= tolerance, `${a} is not ${b}`));

test('the basis is orthonormal, with the picture upright', () => {
  const { forward, right, up } = basis(camera);
  for (const v of [forward, right, up]) assert.ok(Math.abs(dot(v, v) - 1) < 1e-12);
  near([dot(forward, right), dot(right, up), dot(up, forward)], [0, 0, 0]);
  assert.ok(up[2] > 0 && Math.abs(right[2]) < 1e-12);
});

test('orbiting keeps distance, target and horizon, and comes around', () => {
  let turned = camera;
  for (let i = 0; i < 36; i++) {
    turned = orbit(turned, Math.PI / 18, 0);
    assert.ok(Math.abs(distance(turned) - distance(camera)) < 1e-9);
    assert.ok(Math.abs(turned.eye[2] - camera.eye[2]) < 1e-9);
  }
  near(turned.eye, camera.eye);
  near(orbit(orbit(camera, 0.3, 0.2), -0.3, -0.2).eye, camera.eye);
});

test('orbiting stops short of the poles and comes back', () => {
  const top = orbit(camera, 0, 10);
  const { forward } = basis(top);
  assert.ok(forward[2] > -1 && forward[2] < -0.99);
  near(orbit(top, 0, -0.5).eye.slice(0, 2).map(Math.sign), [1, -1]);
});

test('zoom multiplies the distance within its limits', () => {
  assert.ok(Math.abs(distance(zoom(camera, 0.5, 0, 100)) - distance(camera) / 2) < 1e-12);
  assert.ok(Math.abs(distance(zoom(camera, 1e-9, 0.25, 100)) - 0.25) < 1e-12);
  assert.ok(Math.abs(distance(zoom(camera, 1e9, 0.25, 100)) - 100) < 1e-9);
});

test('the ray through a pixel meets what projects there', () => {
  const [width, height] = [640, 360];
  const { forward, right, up } = basis(camera);
  const focal = 1 / Math.tan((camera.vfovDegrees * Math.PI) / 360);
  const point = [0.2, 0.7, 1.4];
  const seen = point.map((x, i) => x - camera.eye[i]);
  const x = width / 2 + ((dot(seen, right) / dot(seen, forward)) * focal * height) / 2;
  const y = height / 2 - ((dot(seen, up) / dot(seen, forward)) * focal * height) / 2;
  const ray = pixelRay(camera, width, height, x, y);
  near(ray.direction, seen.map((v) => v / Math.hypot(...seen)));
  near(pixelRay(camera, width, height, width / 2, height / 2).direction, forward);
});

test('panning by a picture height moves the upper edge to the lower', () => {
  const moved = pan(camera, 0, 1);
  const upperEdge = pixelRay(camera, 100, 100, 50, 0).direction;
  const { forward } = basis(camera);
  const hit = upperEdge.map((x, i) => camera.eye[i] + (x * distance(camera)) / dot(upperEdge, forward));
  const lowerEdge = pixelRay(moved, 100, 100, 50, 100).direction;
  const same = lowerEdge.map((x, i) => moved.eye[i] + (x * distance(camera)) / dot(lowerEdge, forward));
  const shift = moved.target.map((x, i) => x - camera.target[i]);
  near(hit.map((x, i) => x - camera.target[i]), shift.map((x) => x / 2));
  near(same, camera.target.map((x, i) => x + shift[i] / 2));
});

test('in a room the eye stays inside', () => {
  const room = { min: [-2, -2, 0], max: [2, 2, 3] };
  assert.equal(isInside(camera, room), false);
  const kept = keepInside(camera, room, 0.1);
  assert.ok(isInside(kept, room));
  near([kept.eye[1]], [-1.6]);
  near(basis(kept).forward, basis(camera).forward);
  assert.equal(keepInside(kept, room, 0.1), kept);
});

test('a narrow picture shows the same from left to right', () => {
  const [width, height] = [300, 600];
  const narrow = pixelRay(fitAspect(camera, width / height, 4 / 3), width, height, 0, height / 2);
  const designed = pixelRay(camera, 400, 300, 0, 150);
  near(narrow.direction, designed.direction);
  assert.equal(fitAspect(camera, 16 / 9, 4 / 3), camera);
});
