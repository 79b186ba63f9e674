// What the page says: figures and states in words for people.

const count = new Intl.NumberFormat('en');

/** A length with three digits that mean something. */
export const lengthText = (x) => String(Number(x.toPrecision(3)));

const timeText = (seconds) => (seconds < 9.95 ? `${seconds.toFixed(1)} s` : `${Math.round(seconds)} s`);

/** One line on what the renderer is doing; `status` is renderer.js' Status. */
export function statusText({ phase, samples, total, seconds, rays, rounded, message }) {
  const share = rays > 0 ? `${((100 * rounded) / rays).toFixed(1)} % of rays on a rounding` : '';
  switch (phase) {
    case 'moving':
      return ['Moving: coarse picture', share].filter(Boolean).join(' · ');
    case 'rendering':
    case 'done': {
      const doing = phase === 'done' ? 'Done' : 'Rendering';
      return [`${doing}: ${samples} of ${total} samples`, timeText(seconds), share].filter(Boolean).join(' · ');
    }
    case 'waiting':
    case 'failed':
      return message;
    default:
      return 'Ready';
  }
}

/** That something is asked for again after `error`. */
export const retryText = (error, seconds) => `${error.message} Trying again in ${seconds} s.`;

const VERDICTS = { same: 'Same', differs: 'Differs', 'cannot-tell': 'Cannot tell', error: 'Error' };
const STATES = { queued: 'Waiting for its turn', cancelled: 'Cancelled', failed: 'Failed' };

/** A comparison job's state or, once there is one, its verdict. */
export function jobText({ state, outcome, progress }) {
  if (outcome) return VERDICTS[outcome] ?? outcome;
  if (state !== 'running') return STATES[state] ?? state;
  return progress?.most_seeds > 0 ? `Running: ${progress.seeds} of at most ${progress.most_seeds} seeds` : 'Running';
}

export function sceneFacts({ triangles, rounded_edges: roundedEdges }) {
  return `${count.format(triangles)} triangles, ${count.format(roundedEdges)} rounded edges`;
}

const FEATURES = {
  flat: 'flat: an unrounded part of a face',
  cylinder: 'cylinder: a rounded edge',
  sphere: 'sphere: a rounded corner',
};

const vectorText = (v, digits) => v.map((x) => (Math.abs(x) < 0.5 * 10 ** -digits ? 0 : x).toFixed(digits)).join(', ');

/** A hit of POST rays as [name, text] rows; how far away it is sets how many digits a position needs. */
export function hitRows(hit) {
  const digits = Math.max(0, Math.min(9, 4 - Math.floor(Math.log10(hit.t || 1))));
  const rows = [
    ['Feature', FEATURES[hit.feature] ?? hit.feature],
    ['Position', vectorText(hit.position, digits)],
    ['Normal', vectorText(hit.normal, 4)],
    ['Distance', hit.t.toFixed(digits)],
  ];
  for (const name of ['instance', 'solid', 'triangle']) {
    if (Number.isInteger(hit[name])) rows.push([name[0].toUpperCase() + name.slice(1), String(hit[name])]);
  }
  return rows;
}
