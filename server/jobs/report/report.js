// Shows what the element #data holds: {result: as `chamferd compare --json` writes it, pictures: a case's each, and how colours are meant}.
'use strict';

const { result, pictures, gradient, decades, not_finite_color: notFiniteColor, left_out_color: leftOutColor } =
  JSON.parse(document.getElementById('data').textContent);

const OUTCOMES = {
  same: { sign: '✓', text: 'same' },
  differs: { sign: '✗', text: 'differs', many: 'differ' },
  'cannot-tell': { sign: '?', text: 'cannot tell' },
  error: { sign: '!', text: 'error', many: 'errors' },
};
const MOST_OPEN = 12; // cases that are open from the start

/** An element; properties that it has not are set as attributes. */
function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === 'class') element.className = value;
    else if (name.startsWith('--')) element.style.setProperty(name, value);
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== ''));
  return element;
}

function numberText(value, digits = 4) {
  if (value === 'nan') return 'not a number';
  if (value === 'inf') return '∞';
  if (value === '-inf') return '−∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-4 ? value.toExponential(digits - 1) : value.toPrecision(digits);
  const [digitsText, exponent] = text.split('e');
  const short = digitsText.includes('.') ? digitsText.replace(/\.?0+$/, '') : digitsText;
  return (exponent ? `${short}e${exponent.replace('+', '')}` : short).replace('-', '−').replace('e-', 'e−');
}
const percentText = (share) => (typeof share === 'number' ? `${numberText(share * 100, 3)} %` : numberText(share));

const outcomeOf = (word) => OUTCOMES[word] ?? OUTCOMES.error;
const badge = (word) => make('span', { class: 'badge', 'data-outcome': word }, `${outcomeOf(word).sign} ${outcomeOf(word).text}`);
const verdict = (word, text) =>
  make('span', { class: 'verdict', 'data-outcome': word }, `${word === 'none' ? '–' : outcomeOf(word).sign} ${text ?? outcomeOf(word).text}`);

/** What a screen reader is to say. */
function say(text) {
  document.getElementById('said').textContent = text;
}

/** Radio buttons that look like one: options are [value, text] pairs. */
function choice(legend, name, options, onChange) {
  return make('fieldset', { class: 'choice' },
    make('legend', {}, legend),
    options.map(([value, text], i) =>
      make('label', {},
        make('input', { type: 'radio', name, value, checked: i === 0, onchange: () => onChange(value) }),
        make('span', {}, text))));
}

function table(caption, heads, rows) {
  return make('div', { class: 'wide', tabIndex: 0, role: 'group', 'aria-label': caption },
    make('table', {},
      make('thead', {}, make('tr', {}, heads.map((head) => make('th', { scope: 'col' }, head)))),
      make('tbody', {}, rows.map(([first, ...rest]) =>
        make('tr', {}, make('th', { scope: 'row' }, first), rest.map((cell) => make('td', { class: typeof cell === 'string' ? 'number' : '' }, cell)))))));
}

function sideOf(title, side) {
  const rows = side.settings.map(({ name, value }) => [name, value]);
  if (side.is_render) rows.push(['samples', `${side.seeds} seeds of ${side.samples_per_seed}`]);
  if (side.scene_id) rows.push(['scene', side.scene_id]);
  if (side.picture) {
    const { width, height, channels, display, has_variance: hasVariance } = side.picture;
    rows.push(['picture', `${width} × ${height}, ${channels === 1 ? 'grey' : `${channels} channels`}, ${display ? 'display (sRGB)' : 'linear'}${hasVariance ? ', with its variance' : ''}`]);
    rows.push(...side.picture.about.map(({ name, value }) => [name, value]));
  }
  return make('section', {},
    make('h3', {}, title),
    make('dl', { class: 'settings' },
      make('dt', {}, side.is_render ? 'render' : 'image'), make('dd', {}, side.label),
      rows.map(([name, value]) => [make('dt', {}, name), make('dd', {}, value)])));
}

function metricsOf({ metrics, tolerance }) {
  if (metrics.length === 0) return null;
  const words = { same: 'within', differs: 'beyond' };
  const rows = metrics.map(({ name, unit, value, standard_error: error, limit, limit_kind: kind, outcome }) => {
    const withUnit = (text) => (unit ? `${text} ${unit}` : text);
    return [
      name,
      withUnit(numberText(value) + (error === null ? '' : ` ± ${numberText(error, 2)}`)),
      limit === null ? '–' : withUnit(`${kind === 'least' ? '≥' : '≤'} ${numberText(limit)}`),
      limit === null ? verdict('none', 'no limit') : verdict(outcome, words[outcome]),
    ];
  });
  const failing = metrics.some(({ name }) => name === 'failing_share')
    ? make('p', { class: 'quiet' }, `failing_share: pixels with |A − B| above ${numberText(tolerance.absolute)} + ${numberText(tolerance.relative)} |B| in any channel`)
    : null;
  return make('section', { class: 'metrics' }, make('h3', {}, 'Metrics beside their limits'), table('Metrics', ['metric', 'value', 'limit', 'verdict'], rows), failing);
}

function statisticsOf({ statistics }) {
  if (!statistics) return null;
  const { method, significance, seeds, most_seeds: mostSeeds, identical, levels } = statistics;
  const words = identical
    ? make('p', {}, 'No value differs in any seed.')
    : make('ul', { class: 'says' }, levels.map(({ outcome, text }) => make('li', {}, verdict(outcome), ` ${text}`)));
  const rows = levels.map(({ level, block, tests, outcome, p_value: p, worst, channel, a, b, seen_from: seen, bounded_by: bound, resolution }) => [
    block > 1 ? `${level} ${block} × ${block}` : level, verdict(outcome), tests.toLocaleString('en'), numberText(p, 2),
    block > 0 ? `${worst.x}, ${worst.y} ${channel}` : `– ${channel}`, numberText(a), numberText(b), percentText(seen), percentText(bound), percentText(resolution),
  ]);
  return make('section', {},
    make('h3', {}, 'Statistics'),
    make('p', { class: 'quiet' }, `${method[0].toUpperCase()}${method.slice(1)}. Significance ${numberText(significance)}; ${seeds} of at most ${mostSeeds} seeds.`),
    words,
    levels.length === 0 ? null : table('Statistics by level',
      ['level', 'verdict', 'tests', 'p', 'worst place', 'A there', 'B there', 'seen from', 'true ones below', '“same” asks'], rows));
}

function commandOf(command) {
  if (!command) return null;
  const code = make('code', {}, command);
  const button = make('button', { type: 'button', onclick: () => copy(code, button) }, 'Copy');
  return make('section', {}, make('h3', {}, 'To repeat this case'), make('div', { class: 'command' }, make('pre', {}, code), button));
}

async function copy(code, button) {
  try {
    await navigator.clipboard.writeText(code.textContent);
  } catch { // not allowed, or no such thing: the older way
    getSelection().selectAllChildren(code);
    if (!document.execCommand('copy')) return say('Selected; copy it with the keyboard.');
  }
  button.textContent = 'Copied';
  say('Copied');
  setTimeout(() => { button.textContent = 'Copy'; }, 2000);
}

function warningsOf({ warnings, a, b }) {
  const all = [
    ...[['A', a], ['B', b]].filter(([, { stale }]) => stale).map(([name, { stale }]) => [`${name} is stale:`, stale]),
    ...warnings.map((text) => ['Warning:', text]),
  ];
  if (all.length === 0) return null;
  return make('ul', { class: 'warnings' }, all.map(([head, text]) => make('li', {}, make('b', {}, head), ` ${text}`)));
}

function bodyOf(one, index) {
  const { a, b } = pictures[index];
  const { crop, pixels, text } = one.region;
  const region = pixels > 0 ? `${crop.width} × ${crop.height} at ${crop.x}, ${crop.y}${text ? `; ${text}.` : `: ${pixels.toLocaleString('en')} pixels count.`}` : '';
  return make('div', { class: 'body' },
    warningsOf(one),
    a || b ? new Views(index).element : make('p', { class: 'quiet' }, 'No pictures: it never came to one.'),
    make('div', { class: 'columns' }, metricsOf(one), sideOf('A, which is judged', one.a), sideOf('B, which it is judged by', one.b)),
    statisticsOf(one),
    commandOf(one.command),
    make('p', { class: 'quiet' }, [region, `${numberText(one.seconds, 3)} s.`].join(' ')));
}

function caseOf(one, index, isOpen) {
  const element = make('details', { class: 'case', id: `case-${index + 1}`, 'data-outcome': one.outcome },
    make('summary', {}, badge(one.outcome), make('h2', {}, one.name), make('span', { class: 'reason quiet' }, one.reason)));
  const fill = () => element.childElementCount === 1 && element.append(bodyOf(one, index));
  element.addEventListener('toggle', () => element.open && fill());
  if (isOpen) {
    element.open = true;
    fill();
  }
  return element;
}

function headOf() {
  const { program, started, seconds, command, counts, cases, outcome } = result;
  const said = [['same', counts.same], ['differs', counts.differs], ['cannot-tell', counts.cannot_tell], ['error', counts.error]];
  const notSame = cases.length - counts.same;
  const empty = make('p', { id: 'empty', hidden: true }, 'Every case is the same.');
  const filter = (value) => {
    document.body.dataset.filter = value;
    empty.hidden = value === 'all' || notSame > 0;
    say(value === 'all' ? `${cases.length} cases` : `${notSame} cases`);
  };
  document.getElementById('head').replaceChildren(
    make('div', { class: 'title' }, make('h1', {}, 'Comparison'), badge(outcome)),
    make('ul', { class: 'counts', 'aria-label': 'Cases by verdict' },
      said.map(([word, count]) => make('li', {},
        make('span', { class: count > 0 ? 'verdict' : 'quiet', 'data-outcome': word }, `${outcomeOf(word).sign} ${count} ${count === 1 ? outcomeOf(word).text : outcomeOf(word).many ?? outcomeOf(word).text}`)))),
    make('p', { class: 'quiet' }, `${program}, ${started}, ${numberText(seconds, 3)} s`),
    command ? make('p', { class: 'quiet' }, make('code', {}, command)) : '',
    cases.length > 1
      ? choice('Cases', 'filter', [['all', `All (${cases.length})`], ['not-same', `Not same (${notSame})`]], filter)
      : '',
    cases.length === 0 ? make('p', {}, 'No cases: nothing was compared.') : empty);
}

headOf();
let open = 0;
document.getElementById('cases').append(...result.cases.map((one, i) => {
  const isOpen = result.cases.length === 1 || (one.outcome !== 'same' && open < MOST_OPEN) || location.hash === `#case-${i + 1}`;
  if (isOpen) open += 1;
  return caseOf(one, i, isOpen);
}));
if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
