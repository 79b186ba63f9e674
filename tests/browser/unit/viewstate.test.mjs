import assert from 'node:assert/strict';
import { test } from 'node:test';

import { cameraText, decodeView, encodeView, parseCamera } from '../../../web/viewstate.js';

const camera = { eye: [3, -4.25, 2], target: [0, 0, 1], up: [0, 0, 1], vfovDegrees: 35 };

test('a view survives the address', () => {
  const view = { scene: 'solids/a b&c', camera, radius: 0.0125, rounding: 'none', up: 'y', compare: null };
  assert.deepEqual(decodeView(encodeView(view)), view);
  const own = { scene: 'dice', camera: null, radius: null, rounding: 'analytic', up: null, compare: null };
  assert.equal(encodeView(own), '#scene=dice');
  assert.deepEqual(decodeView(encodeView(own)), own);
});

test('equal cameras have equal text, whatever the last bits are', () => {
  const shaken = { ...camera, eye: camera.eye.map((x) => x * (1 + 1e-12)) };
  assert.equal(cameraText(shaken), cameraText(camera));
  assert.equal(cameraText(camera), '3,-4.25,2,0,0,1,0,0,1,35');
  assert.equal(cameraText({ ...camera, target: [-0, 0, 0] }), '3,-4.25,2,0,0,0,0,0,1,35');
});

test('a lens is part of the camera', () => {
  const lens = { ...camera, apertureDiameter: 0.1, focusDistance: 4 };
  assert.deepEqual(parseCamera(cameraText(lens)), lens);
});

test('what is wrong in an address is left out', () => {
  const nothing = { scene: null, camera: null, radius: null, rounding: 'analytic', up: null, compare: null };
  assert.deepEqual(decodeView(''), nothing);
  assert.deepEqual(decodeView('#radius=-1&rounding=soft&camera=1,2,3&up=x&compare=overlay'), nothing);
  for (const rounding of ['mesh', 'mesh:0', 'mesh:257', 'mesh:07', 'none:3', 'bevel:', 'Mesh:3']) {
    assert.deepEqual(decodeView(`#rounding=${rounding}`), nothing, rounding);
  }
  const { compare } = decodeView('#compare=beside&split=101&b-rounding=soft&b-radius=x');
  assert.deepEqual(compare, { mode: 'beside', split: 50, scene: null, rounding: 'analytic', radius: null });
});

test('text that is no camera is refused', () => {
  const faulty = [
    '1,2,3,4,5,6,7,8,9',
    '1,2,3,4,5,6,7,8,,40',
    '1,2,3,4,5,6,7,8,nan,40',
    '1,2,3,1,2,3,0,0,1,40', // eye and target are one point
    '0,0,0,0,0,5,0,0,1,40', // up along the view
    '3,-4,2,0,0,1,0,0,1,180',
  ];
  for (const text of faulty) assert.equal(parseCamera(text), null, text);
});

test('what a view is compared with survives the address', () => {
  const view = { scene: 'dice', camera: null, radius: null, rounding: 'mesh:8', up: null };
  const settings = [
    { mode: 'slider', split: 50, scene: null, rounding: 'none', radius: null },
    { mode: 'difference', split: 0, scene: 'a b&c=d', rounding: 'bevel:256', radius: 0.03 },
    { mode: 'beside', split: 37.5, scene: null, rounding: 'analytic', radius: 2 },
  ];
  for (const compare of settings) assert.deepEqual(decodeView(encodeView({ ...view, compare })), { ...view, compare });
});
