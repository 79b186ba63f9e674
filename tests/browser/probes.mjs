// Values on both sides of the limits that an OpenAPI document states for a parameter.
import assert from 'node:assert/strict';

/**
 * Other path parameters, chosen so that they fit a probed one: a tile must lie in its frame, samples be a range.
 * `largest(name)`: the largest value of a parameter.
 */
export function around(name, value, largest) {
  const number = Number.isInteger(Number(value)) ? Number(value) : 0;
  const fitting = (least, other) => Math.max(least, Math.min(number, largest(other)));
  switch (name) {
    case 'width':
    case 'height':
      return { width: 1, height: 1 };
    case 'x':
      return { width: Math.min(fitting(0, 'x') + 1, largest('width')), height: 1 };
    case 'y':
      return { width: 1, height: Math.min(fitting(0, 'y') + 1, largest('height')) };
    case 'w':
      return { width: fitting(1, 'width'), height: 1 };
    case 'h':
      return { width: 1, height: fitting(1, 'height') };
    case 's0':
      return { s1: Math.min(fitting(0, 's0') + 1, largest('s1')) };
    case 's1':
      return { s0: Math.max(0, Math.min(number - 1, largest('s0'))) };
    default:
      return {};
  }
}

/**
 * {inside: values that work, outside: [value, status, parameter at fault?][]} for a parameter of the document; null where
 * any text may be a value. `maxRadius`: the scene's own limit, which comes before the document's.
 */
export function probesOf({ name, schema }, maxRadius) {
  const { type, minimum, exclusiveMinimum, maximum } = schema;
  if (schema.enum) {
    return { inside: schema.enum, outside: ['frob', '', schema.enum[0].toUpperCase()].map((word) => [word, 400]) };
  }
  if (schema.pattern) {
    return {
      inside: ['analytic', 'none', 'mesh:1', 'mesh:256', 'bevel:1', 'bevel:256'],
      outside: [['frob', 400], ['mesh', 400], ['mesh:257', 422], ['bevel:0', 422], ['bevel:257', 422]],
    };
  }
  if (type === 'array') return numberListProbes(schema);
  if (type === 'integer') {
    const below = minimum === 0 ? [-1, 400] : [minimum - 1, 422];
    const wrong = ['1.5', '007', '+1', ''].map((text) => [text, 400]);
    return { inside: [minimum, maximum], outside: [below, [maximum + 1, 422], ['9'.repeat(20), 422], ...wrong] };
  }
  if (type !== 'number') return null;
  const least = minimum ?? exclusiveMinimum;
  const outside = [least - 1, maximum * 1.001, '1e999', 'nan'].map((value) => [value, 422]);
  outside.push(['x', 400], ['', 400]);
  if (minimum === undefined) outside.push([least, 422]);
  if (name === 'radius') {
    outside.push([maxRadius, 422]);
    return { inside: [maxRadius * 1e-3, maxRadius * 0.999], outside };
  }
  return { inside: [minimum ?? least + 1e-6, maximum], outside };
}

/** The camera: eye, target, up, vertical field of view, and a lens or none. */
function numberListProbes({ minItems, maxItems, prefixItems }) {
  const numbers = [3, -3, 2, 0, 0, 0, 1, 1, 1, 40, 0.1, 3];
  assert.equal(numbers.length, maxItems);
  const put = (at, value) => numbers.map((number, i) => (i === at ? value : number)).join();
  const inside = [numbers.slice(0, minItems).join(), numbers.join()];
  const outside = [numbers.slice(0, minItems - 1), numbers.slice(0, minItems + 1), [...numbers, 1]].map((list) => [
    list.join(),
    400,
  ]);
  for (const [i, item] of prefixItems.slice(0, 3).entries()) {
    for (const limit of [item.minimum, item.maximum]) {
      inside.push(put(i, limit));
      outside.push([put(i, limit * 1.001), 422]);
    }
  }
  const angle = prefixItems[9];
  inside.push(put(9, angle.minimum), put(9, angle.maximum));
  outside.push([put(9, angle.minimum * 0.99), 422, angle.title], [put(9, angle.maximum * 1.01), 422, angle.title]);
  return { inside, outside };
}
