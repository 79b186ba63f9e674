// The other side, B: which scene and settings it has, its part of the panel, and how the two lie over each other. A is the view
// that the rest of the page is about.
import { Divider } from './divider.js';
import { gradient, ticks } from './difference.js';
import { sceneOptions, showAmount, showRadiusSlider } from './panel.js';
import { RadiusScale } from './radius.js';
import { parseRounding, roundingText, roundingWord } from './rounding.js';
import { lengthText } from './words.js';

const byId = (id) => document.getElementById(id);

export class Comparison {
  /**
   * `page`: changed({moving}) when what B shows is another, moved() when only the divider or the mode is, swapped(settings of B),
   * main() the {scene, rounding, radius} of A, load(name, signal) a scene in full, or null when that failed.
   */
  constructor(page) {
    this.page = page;
    this.mode = 'off';
    this.split = 50;
    this.scene = null; // in full; null: A's
    this.rounding = 'none';
    this.radius = null; // null: the scene's own
    this.amounts = {};
    this.wasOn = false;
    this.scenes = null; // as listed
    this.list = '';
    this.loading = new AbortController();
    this.modes = [...document.querySelectorAll('input[name="compare"]')];
    for (const radio of this.modes) radio.addEventListener('change', () => this.#setMode(radio.value));
    this.divider = new Divider(byId('divider'), (split) => {
      this.split = split;
      this.divider.show(split);
      page.moved();
    });
    byId('scene-b').addEventListener('change', ({ target }) => this.#pickScene(target.value));
    const pickRounding = (kind) => {
      this.rounding = roundingWord(kind, this.amounts[kind]);
      page.changed();
    };
    byId('rounding-b').addEventListener('change', ({ target }) => pickRounding(target.value));
    byId('amount-b').addEventListener('change', ({ target }) => {
      this.amounts[byId('rounding-b').value] = target.value;
      pickRounding(byId('rounding-b').value);
    });
    for (const [name, moving] of [['input', true], ['change', false]]) {
      byId('radius-b').addEventListener(name, ({ target }) => {
        this.radius = this.#scale().radiusAt(Number(target.value));
        page.changed({ moving });
      });
    }
    byId('reset-radius-b').addEventListener('click', () => {
      this.radius = null;
      page.changed();
    });
    byId('swap').addEventListener('click', () => this.#swap());
    byId('scale-bar').style.background = `linear-gradient(to right, ${gradient})`;
  }

  get isOn() {
    return this.mode !== 'off';
  }

  get showsDifference() {
    return this.mode === 'difference';
  }

  /** B as `sideOf(A)`: {scene, view}; the camera is A's. */
  sideOf({ scene, view }) {
    const own = this.scene ?? scene;
    return { scene: own, view: { ...view, sceneId: own.id, rounding: this.#scale() ? this.rounding : 'none', radius: this.#shownRadius() } };
  }

  /** For the address; null while it is off. */
  link() {
    if (!this.isOn) return null;
    const { mode, split, rounding, radius } = this;
    return { mode, split, scene: this.scene?.name ?? null, rounding, radius };
  }

  /** Takes what a link asks for, null for nothing; `name`: A's scene. True: a scene of its own has come, later. */
  async follow(wanted, name) {
    this.loading.abort();
    this.mode = wanted?.mode ?? 'off';
    this.scene = null;
    if (!wanted) return false;
    Object.assign(this, { split: wanted.split, rounding: wanted.rounding, radius: wanted.radius });
    this.wasOn = true;
    return wanted.scene !== null && wanted.scene !== name && this.#load(wanted.scene);
  }

  /** A shows another scene: B is what it was only where it has one of its own. */
  forgetRadius() {
    if (!this.scene) this.radius = null;
  }

  /** Another scene, or another state of it, goes by B's name; or a mesh is turned over. */
  async refresh(scenes, { isTurned = false } = {}) {
    this.scenes = scenes;
    this.#listScenes();
    const now = scenes.find(({ name }) => name === this.scene?.name);
    if (!now || (now.state ?? 'ready') !== 'ready') return;
    if (isTurned || now.id !== this.scene.listedId) {
      if (await this.#load(now.name)) this.page.changed();
    }
  }

  /** Brings the panel and the picture's frame in line. */
  show() {
    const { scene, rounding, radius } = this.page.main();
    for (const radio of this.modes) {
      radio.checked = radio.value === this.mode;
      radio.disabled = false;
    }
    for (const element of document.querySelectorAll('.of-a')) element.hidden = !this.isOn;
    byId('view').dataset.mode = this.mode;
    const shown = { other: this.isOn, divider: this.mode === 'slider', 'picture-b': ['slider', 'beside'].includes(this.mode),
      'heat-map': this.showsDifference, scale: this.showsDifference };
    for (const [id, isShown] of Object.entries(shown)) byId(id).hidden = !isShown;
    for (const id of ['side-a', 'side-b']) byId(id).hidden = !this.isOn || this.showsDifference;
    this.divider.show(this.split);
    if (!this.isOn) return;
    this.#listScenes();
    byId('scene-b').value = this.scene?.name ?? '';
    const scale = this.#scale();
    const { kind, amount } = parseRounding(this.rounding);
    byId('rounding-b').value = scale ? kind : 'none';
    byId('rounding-b').disabled = !scale;
    showAmount('amount-b', kind, scale ? amount : null);
    if (amount !== null) this.amounts[kind] = amount;
    const own = this.scene ?? scene;
    const isRounded = scale !== null && kind !== 'none';
    showRadiusSlider('radius-b', scale, this.#shownRadius() ?? own.radius?.current ?? 0, isRounded);
    byId('reset-radius-b').disabled = !isRounded || this.radius === null;
    this.#nameSides([{ scene, rounding, radius }, { scene: own, rounding: scale ? this.rounding : 'none', radius: this.#shownRadius() }]);
  }

  /** The difference's scale: `top` is its bright end. */
  showScale(top, isKnown) {
    const texts = ticks(top);
    byId('scale-bar').hidden = byId('scale-ticks').hidden = texts.length === 0;
    if (byId('scale-ticks').textContent !== texts.join('')) {
      byId('scale-ticks').replaceChildren(...texts.map((text) => Object.assign(document.createElement('span'), { textContent: text })));
    }
    const none = isKnown ? 'No value differs.' : 'Not known yet.';
    byId('scale-note').textContent = texts.length > 0 ? 'Logarithmic scale of linear values.' : none;
  }

  #nameSides(sides) {
    const isOneScene = sides[0].scene.name === sides[1].scene.name;
    for (const [i, { scene, rounding, radius }] of sides.entries()) {
      const size = radius ?? scene.radius?.current;
      const words = [isOneScene ? '' : scene.name, roundingText(rounding), rounding === 'none' || !size ? '' : `r ${lengthText(size)}`];
      const text = words.filter(Boolean).join(', ');
      byId(['side-a', 'side-b'][i]).querySelector('span').textContent = text;
      if (i === 1) byId('picture-b').setAttribute('aria-label', `Side B: ${text}`);
    }
  }

  #setMode(mode) {
    const { rounding, radius } = this.page.main();
    // Turned on for the first time: against what the method is there for.
    if (!this.isOn && !this.wasOn) Object.assign(this, { rounding: rounding === 'none' ? 'analytic' : 'none', radius, wasOn: true });
    this.mode = mode;
    this.page.changed();
  }

  async #pickScene(name) {
    if (name === '') {
      this.loading.abort();
      this.scene = null;
    } else if (!(await this.#load(name))) {
      byId('scene-b').value = this.scene?.name ?? ''; // what it still is
      return;
    }
    this.radius = null;
    this.page.changed();
  }

  async #load(name) {
    this.loading.abort();
    const { signal } = (this.loading = new AbortController());
    const scene = await this.page.load(name, signal);
    if (signal.aborted || !scene) return false;
    this.scene = scene;
    return true;
  }

  #swap() {
    const { scene, rounding, radius } = this.page.main();
    const other = { scene: this.scene, rounding: this.rounding, radius: this.radius };
    if (this.scene) this.scene = scene;
    Object.assign(this, { rounding, radius });
    this.page.swapped(other);
  }

  #scale() {
    const { current, max } = (this.scene ?? this.page.main().scene).radius ?? {};
    return max > 0 ? new RadiusScale(max, current ?? 0) : null;
  }

  #shownRadius() {
    const scale = this.#scale();
    return this.radius === null || !scale ? null : Math.min(this.radius, scale.top);
  }

  #listScenes() {
    const { scene } = this.page.main();
    const list = JSON.stringify([scene?.name, this.scenes]);
    if (list === this.list || !this.scenes) return;
    this.list = list;
    const others = this.scenes.filter(({ name }) => name !== scene?.name);
    byId('scene-b').replaceChildren(new Option('Same as A', ''), ...sceneOptions(others));
    byId('scene-b').value = this.scene?.name ?? '';
  }
}
