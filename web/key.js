// The key that a server may ask for: kept for this tab alone, until it is closed, and sent as a header, so that it is in no
// address, no history and no log.
const NAME = 'chamfer-key';

/** Where sessionStorage is barred, the key lasts as long as the page. */
let kept = null;

/** Request headers with the key; none without one. */
export function keyHeaders() {
  const key = read();
  return key ? { Authorization: `Bearer ${key}` } : {};
}

export const hasKey = () => Boolean(read());

/** Can this be sent at all? A header's value is visible ASCII. */
export const isSendable = (key) => /^[\x21-\x7e]+$/.test(key);

export function rememberKey(key) {
  kept = key;
  try {
    sessionStorage.setItem(NAME, key);
  } catch {
    // `kept` has it.
  }
}

function read() {
  try {
    return sessionStorage.getItem(NAME) ?? kept;
  } catch {
    return kept;
  }
}
