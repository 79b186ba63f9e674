// The roundings that a picture can be asked with, as the server's `rounding=` spells them: none, analytic, mesh:K of K
// segments, bevel:N of N probe rays.

export const MOST = 256; // segments or probes
const USUAL = { mesh: 8, bevel: 16 };
const UNITS = { mesh: 'segments', bevel: 'probes' };

/** {kind, amount} of such a word, amount null where the kind has none; null where the word is no rounding. */
export function parseRounding(word) {
  const [, kind, digits] = /^(none|analytic|mesh(?=:)|bevel(?=:))(?::([1-9]\d{0,2}))?$/.exec(word ?? '') ?? [];
  if (!kind || hasAmount(kind) !== Boolean(digits) || Number(digits) > MOST) return null;
  return { kind, amount: digits ? Number(digits) : null };
}

export const hasAmount = (kind) => kind in USUAL;

/** The word of a kind, with the amount that is nearest to what was typed. */
export function roundingWord(kind, typed) {
  if (!hasAmount(kind)) return kind;
  const amount = Math.round(Number(typed));
  return `${kind}:${amount >= 1 ? Math.min(amount, MOST) : USUAL[kind]}`;
}

/** For people: "mesh of 8 segments". */
export function roundingText(word) {
  const { kind, amount } = parseRounding(word);
  if (!hasAmount(kind)) return kind === 'none' ? 'no rounding' : kind;
  return `${kind} of ${amount} ${amount === 1 ? UNITS[kind].slice(0, -1) : UNITS[kind]}`;
}
