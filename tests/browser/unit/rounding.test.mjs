import assert from 'node:assert/strict';
import { test } from 'node:test';

import { parseRounding, roundingText, roundingWord } from '../../../web/rounding.js';

test('roundings are read as the server spells them, and nothing else is one', () => {
  assert.deepEqual(parseRounding('none'), { kind: 'none', amount: null });
  assert.deepEqual(parseRounding('mesh:16'), { kind: 'mesh', amount: 16 });
  assert.deepEqual(parseRounding('bevel:256'), { kind: 'bevel', amount: 256 });
  for (const word of ['', null, undefined, 'mesh', 'mesh:', 'mesh:0', 'mesh:1.5', 'mesh:257', 'bevel:999', 'analytic:2', ' none']) {
    assert.equal(parseRounding(word), null, `${word}`);
  }
});

test('whatever is typed becomes an amount that the server takes', () => {
  const typed = [['12', 'mesh:12'], ['300', 'mesh:256'], ['2.6', 'mesh:3'], ['0', 'mesh:8'], ['', 'mesh:8'], [undefined, 'mesh:8'], ['x', 'mesh:8']];
  for (const [text, word] of typed) assert.equal(roundingWord('mesh', text), word, `${text}`);
  assert.equal(roundingWord('none', '5'), 'none');
  assert.equal(roundingText('mesh:1'), 'mesh of 1 segment');
  assert.equal(roundingText('bevel:16'), 'bevel of 16 probes');
});
