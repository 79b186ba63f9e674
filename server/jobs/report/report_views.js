// The pictures of a case in the report: a slider between the two or both side by side, the map of their difference, marks, zoom.
'use strict';

// result, pictures, the colours, make, choice, numberText and say are of report.js.

const ZOOMS = [1, 2, 4, 8, 16];
const PLACE_ZOOM = 8; // that a place is shown with

/** The pictures of a case, their zoom, marks and the divider between them. */
class Views {
  constructor(index) {
    this.one = result.cases[index];
    this.shown = pictures[index];
    this.index = index;
    this.zoom = 0; // fits
    this.split = 50; // per cent of what is seen
    this.frames = [];
    this.grid = make('div', { class: 'views' });
    this.element = make('div', { class: 'pictures' }, this.controls(), this.grid, this.notes());
    this.setMode(this.canWipe() ? 'slider' : 'beside');
  }

  canWipe() {
    const { a, b } = this.shown;
    return a && b && a.width === b.width && a.height === b.height && a.factor === b.factor;
  }

  controls() {
    this.zoomSelect = make('select', { onchange: () => this.setZoom(Number(this.zoomSelect.value)) },
      make('option', { value: 0 }, 'fit'), ZOOMS.map((zoom) => make('option', { value: zoom }, `${zoom} ×`)));
    return make('div', { class: 'controls' },
      this.canWipe()
        ? choice('View', `view-${this.index}`, [['slider', 'Slider'], ['beside', 'Side by side']], (mode) => this.setMode(mode))
        : null,
      make('label', { class: 'field' }, 'Zoom', this.zoomSelect),
      this.marksOf().length > 0
        ? make('label', { class: 'field check' },
            make('input', { type: 'checkbox', checked: true, onchange: ({ target }) => this.grid.classList.toggle('unmarked', !target.checked) }),
            'Marks')
        : null);
  }

  /** Places to mark: {kind, x, y, width, height, text}, in pixels of the frame. */
  marksOf() {
    const { largest, statistics } = this.one;
    const marks = [];
    const worst = (statistics?.levels ?? [])
      .filter(({ block, worst: { width } }) => block > 0 && width > 0)
      .reduce((most, level) => (most === null || level.p_value < most.p_value ? level : most), null);
    if (worst && !statistics.identical) {
      const { worst: rect, level } = worst;
      marks.push({ kind: 'box', ...rect, text: `stands out most from the noise (${level}): ${rect.x}, ${rect.y}` });
    }
    if (largest && largest.error !== 0) {
      marks.push({
        kind: 'ring', x: largest.x, y: largest.y, width: 1, height: 1,
        text: `largest difference: ${numberText(largest.error)} at ${largest.x}, ${largest.y} (${largest.channel}: A ${numberText(largest.a)}, B ${numberText(largest.b)})`,
      });
    }
    return marks;
  }

  notes() {
    const { a, b, heat } = this.shown;
    const lines = this.marksOf().map((mark) =>
      make('li', {}, make('span', { class: `mark ${mark.kind} sample` }), ` ${mark.text} `,
        make('button', { type: 'button', class: 'place', 'aria-label': `Show: ${mark.text}`, onclick: () => this.showPlace(mark) }, 'Show')));
    const factor = Math.max(a?.factor ?? 1, b?.factor ?? 1);
    if (factor > 1) {
      lines.push(make('li', {}, `Shown smaller: each pixel is the mean of ${factor} × ${factor} pixels; in the map of the difference it is the largest of them.`));
    }
    const ratio = a ? a.width / a.height : 1;
    if (Math.max(ratio, 1 / ratio) > 20) lines.push(make('li', {}, 'A thin picture: where it fits the window it may look thicker than it is.'));
    if (this.one.a.picture?.display === false || this.one.b.picture?.display === false) {
      lines.push(make('li', {}, 'Linear values, shown sRGB-encoded; what is below 0 or above 1 looks like 0 or 1.'));
    }
    for (const [name, side] of [['A', a], ['B', b]]) {
      if (side?.not_finite > 0) {
        lines.push(make('li', {}, make('span', { class: 'swatch' }), `${name} has ${side.not_finite} values that are no finite numbers: drawn in this colour.`));
        lines.at(-1).firstChild.style.background = notFiniteColor;
      }
    }
    if (!heat && a && b) lines.push(make('li', {}, 'No map of the difference: the pictures are not of one size and number of channels.'));
    return make('ul', { class: 'notes' }, lines);
  }

  setMode(mode) {
    const { a, b, heat } = this.shown;
    this.frames = [];
    const figures = [];
    if (mode === 'slider') {
      figures.push(this.figure(['A on the left, B on the right'], [b, a], true));
    } else {
      if (a) figures.push(this.figure([make('b', {}, 'A'), ` ${this.one.a.label}`], [a]));
      if (b) figures.push(this.figure([make('b', {}, 'B'), ` ${this.one.b.label}`], [b]));
    }
    if (heat) {
      const figure = this.figure(['Difference: largest |A − B| of the channels'], [heat]);
      figure.append(scaleOf(heat));
      figures.push(figure);
    }
    this.grid.replaceChildren(...figures);
    this.setZoom(this.zoom);
    this.setSplit(this.split);
  }

  /** One picture, or two of which the upper (the last) ends at the divider. */
  figure(caption, sources, isWiped = false) {
    const [{ width, height }] = sources;
    const enlarge = Math.max(1, Math.floor(512 / Math.max(width, height))); // tiny pictures
    const alt = (i) => (isWiped ? ['B', 'A'][i] : caption.map((part) => part.textContent ?? part).join(''));
    const images = sources.map(({ uri }, i) => make('img', { src: uri, alt: alt(i), draggable: false }));
    const stage = make('div', { class: 'stage' }, images, this.marks(sources[0]));
    const viewport = make('div', { class: 'viewport', role: 'group', 'aria-label': 'Picture', onscroll: () => this.follow(viewport) }, stage);
    const frame = make('div', {
      class: `frame${enlarge > 1 ? ' pixelated' : ''}`,
      '--ratio': width / height, '--most': `${width * enlarge}px`,
    });
    const box = make('div', { class: 'viewport-box' }, viewport);
    frame.append(box);
    const view = { frame, viewport, stage, width, isEnlarged: enlarge > 1 };
    if (isWiped) {
      view.upper = images[1];
      view.divider = make('div', { class: 'divider' });
      view.wipe = make('input', {
        type: 'range', class: 'wipe', min: 0, max: 100, step: 'any', value: this.split,
        'aria-label': 'Divider between A and B', oninput: ({ target }) => this.setSplit(Number(target.value)),
      });
      box.append(view.divider, make('span', { class: 'side-name left' }, 'A'), make('span', { class: 'side-name right' }, 'B'));
      frame.append(view.wipe);
    }
    this.frames.push(view);
    return make('figure', {}, make('figcaption', {}, caption), frame);
  }

  marks({ width, height, factor }) {
    const { crop } = this.one.region;
    const [fullWidth, fullHeight] = [width * factor, height * factor];
    return this.marksOf().map((mark) => {
      const left = mark.x - crop.x, top = mark.y - crop.y;
      const element = make('div', { class: `mark ${mark.kind}` });
      const middle = mark.kind === 'ring' ? 0.5 : 0;
      Object.assign(element.style, { left: `${(100 * (left + middle)) / fullWidth}%`, top: `${(100 * (top + middle)) / fullHeight}%` });
      if (mark.kind === 'box') {
        Object.assign(element.style, { width: `${(100 * mark.width) / fullWidth}%`, height: `${(100 * mark.height) / fullHeight}%` });
      }
      return element;
    });
  }

  setZoom(zoom) {
    this.zoom = zoom;
    this.zoomSelect.value = String(zoom);
    for (const { frame, viewport, stage, width, isEnlarged } of this.frames) {
      frame.classList.toggle('zoomed', zoom > 0);
      frame.classList.toggle('pixelated', zoom > 0 || isEnlarged);
      stage.style.setProperty('--width', `${width * zoom}px`);
      // What scrolls must be reached by the keyboard.
      if (zoom > 0) viewport.tabIndex = 0;
      else viewport.removeAttribute('tabindex');
    }
    this.setSplit(this.split);
  }

  /** The divider stays where it is in the window, whatever part of the picture is behind it. */
  setSplit(split) {
    this.split = split;
    for (const { viewport, stage, upper, divider, wipe } of this.frames) {
      if (!upper) continue;
      const seen = Math.min(viewport.clientWidth, stage.clientWidth) || 1, whole = stage.clientWidth || 1;
      const edge = this.zoom > 0 ? (100 * (viewport.scrollLeft + (seen * split) / 100)) / whole : split;
      upper.style.clipPath = `inset(0 ${100 - edge}% 0 0)`;
      divider.style.left = this.zoom > 0 ? `${(seen * split) / 100}px` : `${split}%`;
      wipe.value = split;
      wipe.setAttribute('aria-valuetext', `A left of ${Math.round(split)} %, B right of it`);
    }
  }

  /** All pictures of a case show the same part. */
  follow(leader) {
    for (const { viewport } of this.frames) {
      if (viewport !== leader && (viewport.scrollLeft !== leader.scrollLeft || viewport.scrollTop !== leader.scrollTop)) {
        viewport.scrollTo(leader.scrollLeft, leader.scrollTop);
      }
    }
    this.setSplit(this.split);
  }

  showPlace({ x, y, width, height }) {
    const { crop } = this.one.region;
    this.setZoom(PLACE_ZOOM);
    const factor = this.shown.heat?.factor ?? this.shown.a?.factor ?? 1;
    const [{ viewport }] = this.frames;
    viewport.scrollTo(
      ((x - crop.x + width / 2) / factor) * PLACE_ZOOM - viewport.clientWidth / 2,
      ((y - crop.y + height / 2) / factor) * PLACE_ZOOM - viewport.clientHeight / 2,
    );
    this.follow(viewport);
    this.element.scrollIntoView({ block: 'nearest' });
    say(`Shown ${PLACE_ZOOM} times as large`);
  }
}

function scaleOf({ largest, has_left_out: hasLeftOut, not_finite: notFinite }) {
  const legend = [];
  const swatch = (color, text) => {
    const element = make('span', { class: 'swatch' });
    element.style.background = color;
    legend.push(make('span', {}, element, text));
  };
  if (hasLeftOut) swatch(leftOutColor, 'left out (region)');
  if (notFinite > 0) swatch(notFiniteColor, 'not a finite number');
  const facts = legend.length > 0 ? make('div', { class: 'facts quiet' }, legend) : null;
  if (!(largest > 0)) return make('div', { class: 'scale' }, make('p', { class: 'quiet' }, 'No value differs where it counts.'), facts);
  const bar = make('div', { class: 'bar' });
  bar.style.background = `linear-gradient(to right, ${gradient})`;
  const ticks = Array.from({ length: decades + 1 }, (_, i) => numberText(largest / 10 ** (decades - i), 3));
  ticks[0] = `≤ ${ticks[0]}`;
  return make('div', { class: 'scale' }, bar,
    make('div', { class: 'ticks number' }, ticks.map((tick) => make('span', {}, tick))),
    make('p', { class: 'quiet' }, `Logarithmic scale; the largest difference is ${numberText(largest)}.`), facts);
}
