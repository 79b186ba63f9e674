// Repeatable variety: numbers that look random and are the same on every machine.

/** A generator of numbers in [0, 1) with its own state (mulberry32 by Tommy Ettinger, public domain). */
export function randomFrom(seed) {
  let state = seed >>> 0;
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  return {
    next,
    between: (low, high) => low + (high - low) * next(),
    /** One of the list's entries. */
    among: (list) => list[Math.floor(next() * list.length)],
  };
}
