import assert from 'node:assert/strict';
import { test } from 'node:test';

import { hitRows, sceneFacts, statusText } from '../../../web/words.js';

const status = { phase: 'rendering', samples: 8, total: 256, seconds: 1.24, rays: 2000, rounded: 275, message: '' };

test('the status says samples, time and the share of rounded rays', () => {
  assert.equal(statusText(status), 'Rendering: 8 of 256 samples · 1.2 s · 13.8 % of rays on a rounding');
  assert.equal(
    statusText({ ...status, phase: 'done', samples: 256, seconds: 72.4, rays: 0 }),
    'Done: 256 of 256 samples · 72 s',
  );
  assert.equal(statusText({ ...status, phase: 'waiting', message: 'Busy.' }), 'Busy.');
});

test('a hit is told with digits that suit its distance', () => {
  const hit = { t: 2.5, position: [1, -2.00000001, 1e-12], normal: [0, -0, 1], feature: 'sphere', instance: 3, solid: null };
  const rows = Object.fromEntries(hitRows(hit));
  assert.deepEqual(rows, {
    Feature: 'sphere: a rounded corner',
    Position: '1.0000, -2.0000, 0.0000',
    Normal: '0.0000, 0.0000, 1.0000',
    Distance: '2.5000',
    Instance: '3',
  });
});

test('figures of a scene', () => {
  assert.equal(sceneFacts({ triangles: 27600, rounded_edges: 1 }), '27,600 triangles, 1 rounded edges');
});
