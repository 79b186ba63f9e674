import assert from 'node:assert/strict';
import { test } from 'node:test';

import { RadiusScale } from '../../../web/radius.js';

test('the scale runs from a hundredth of the largest radius to just below it', () => {
  const scale = new RadiusScale(0.5, 0.08);
  assert.equal(scale.radiusAt(0), 0.005);
  const top = scale.radiusAt(scale.steps);
  assert.ok(top < 0.5 && top > 0.499);
});

test('it rises, and positions come back', () => {
  const scale = new RadiusScale(3.7, 0.1);
  let last = 0;
  for (let position = 0; position <= scale.steps; position += 10) {
    const radius = scale.radiusAt(position);
    assert.ok(radius > last && radius < 3.7);
    assert.ok(Math.abs(scale.positionOf(radius) - position) <= 1);
    last = radius;
  }
});

test('a scene rounded by less than a hundredth can be shown as it is', () => {
  const scale = new RadiusScale(1, 0.001);
  assert.equal(scale.radiusAt(0), 0.001);
  assert.equal(scale.positionOf(0.001), 0);
});
