// Node.js has no sessionStorage: the key lasts as long as the module.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { isSendable, keyHeaders, rememberKey } from '../../../web/key.js';

test('a key goes into the Authorization header, and none before it is known', () => {
  assert.deepEqual(keyHeaders(), {});
  rememberKey('0123456789abcdef');
  assert.deepEqual(keyHeaders(), { Authorization: 'Bearer 0123456789abcdef' });
  rememberKey('another-key-0123');
  assert.deepEqual(keyHeaders(), { Authorization: 'Bearer another-key-0123' });
});

test('what no header can carry is told from a key', () => {
  for (const key of ['a', '0123456789abcdef', '~!{}']) assert.ok(isSendable(key), key);
  for (const text of ['', 'a b', 'a\n', 'schlüssel', '\u{1f511}']) assert.ok(!isSendable(text), text);
});
