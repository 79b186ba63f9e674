// IEEE 754 half-precision floats, through a table of all 65,536 values.

const TABLE = new Float32Array(65536);
for (let bits = 0; bits < 65536; bits++) TABLE[bits] = halfToNumber(bits);

/** Value of the 16 bits of a half float; infinities and NaN included. */
export function halfToNumber(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

/** Float32Array with the values of a little-endian sequence of half floats at `offset` of an ArrayBuffer. */
export function decodeHalfs(buffer, offset, count) {
  const view = new DataView(buffer, offset, count * 2);
  const values = new Float32Array(count);
  for (let i = 0; i < count; i++) values[i] = TABLE[view.getUint16(i * 2, true)];
  return values;
}
