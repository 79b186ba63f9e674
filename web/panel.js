// The panel beside the picture: its elements, shown and read. Knows nothing of cameras, tiles or the server.
import { isSendable } from './key.js';
import { parseRounding, roundingWord } from './rounding.js';
import { hitRows, lengthText, sceneFacts, statusText } from './words.js';

const byId = (id) => document.getElementById(id);

/** The options of a list of scenes, by folder. */
export function sceneOptions(scenes) {
  const groups = new Map([['', document.createDocumentFragment()]]);
    for (const { name, state = 'ready', error } of scenes) {
      const [folder, title] = [name.slice(0, Math.max(0, name.lastIndexOf('/'))), name.slice(name.lastIndexOf('/') + 1)];
      const option = new Option(state === 'ready' ? title : `${title} (${state})`, name);
      option.disabled = state !== 'ready';
      option.title = error?.detail ?? '';
      if (!groups.has(folder)) groups.set(folder, Object.assign(document.createElement('optgroup'), { label: folder }));
      groups.get(folder).append(option);
    }
  return groups.values();
}

/** The field `id` for the number of segments or probes, with its name beside it; hidden for the other kinds. */
export function showAmount(id, kind, amount) {
  byId(`${id}-field`).hidden = amount === null;
  if (amount === null) return;
  byId(`${id}-name`).textContent = kind === 'mesh' ? 'Segments of a rounded edge' : 'Probe rays of each hit';
  byId(id).value = amount;
}

/** `scale`: a RadiusScale, or null where nothing is rounded. */
export function showRadiusSlider(id, scale, radius, enabled) {
  const slider = byId(id);
  slider.disabled = !enabled;
  byId(`${id}-text`).textContent = scale ? lengthText(radius) : '';
  if (!scale) return;
  slider.max = scale.steps;
  slider.value = scale.positionOf(radius);
  slider.setAttribute('aria-valuetext', lengthText(radius));
}

export class Panel {
  /** `handlers`: scene(name), up(axis), rounding(word), radius(position, {final}), resetRadius(), resetCamera(). */
  constructor(handlers) {
    this.failure = '';
    this.notice = '';
    this.list = '';
    this.roundings = [...document.querySelectorAll('input[name="rounding"]')];
    this.upAxes = [...document.querySelectorAll('input[name="up"]')];
    byId('scene').addEventListener('change', (event) => handlers.scene(event.target.value));
    const pickRounding = (kind) => handlers.rounding(roundingWord(kind, this.amounts[kind]));
    this.amounts = {}; // of mesh and bevel, as they were last
    for (const radio of this.roundings) radio.addEventListener('change', () => pickRounding(radio.value));
    byId('amount').addEventListener('change', ({ target }) => {
      const { value: kind } = this.roundings.find((radio) => radio.checked);
      this.amounts[kind] = target.value;
      pickRounding(kind);
    });
    for (const radio of this.upAxes) radio.addEventListener('change', () => handlers.up(radio.value));
    const radius = byId('radius');
    radius.addEventListener('input', () => handlers.radius(Number(radius.value), { final: false }));
    radius.addEventListener('change', () => handlers.radius(Number(radius.value), { final: true }));
    byId('reset-radius').addEventListener('click', handlers.resetRadius);
    byId('reset-camera').addEventListener('click', handlers.resetCamera);
  }

  /**
   * Fills the picker, by folder, and shows `selected`; scenes that are not ready are listed, with the reason, but cannot be
   * picked. A list that is the same is left alone, since it may be open.
   */
  listScenes(scenes, selected) {
    const list = JSON.stringify(scenes.map(({ name, state, error }) => [name, state, error?.detail]));
    if (list === this.list) return;
    this.list = list;
    byId('scene').replaceChildren(...sceneOptions(scenes));
    byId('scene').disabled = scenes.length === 0;
    byId('scene').value = selected;
  }

  showScene(scene) {
    document.title = `${scene.name} – Chamfer`;
    byId('scene').value = scene.name;
    byId('facts').textContent = sceneFacts(scene);
    byId('picture').setAttribute('aria-label', `Rendered scene ${scene.name}`);
    byId('reset-camera').disabled = false;
    byId('up-axis').hidden = !scene.up_axis; // a scene file says it of each of its meshes
    for (const radio of this.upAxes) radio.checked = radio.value === scene.up_axis?.current;
  }

  showRounding(word, available) {
    const { kind, amount } = parseRounding(word);
    for (const radio of this.roundings) {
      radio.checked = radio.value === kind;
      radio.disabled = !available;
    }
    showAmount('amount', kind, amount);
    if (amount !== null) this.amounts[kind] = amount;
    byId('amount').disabled = !available;
  }

  /** `scale`: a RadiusScale, or null where nothing is rounded. `own`: is it the scene's own radius? */
  showRadius(scale, radius, { own, enabled }) {
    byId('reset-radius').disabled = !enabled || own;
    byId('radius-note').textContent = scale ? `Largest: ${lengthText(scale.top)}` : 'Nothing in this scene is rounded.';
    showRadiusSlider('radius', scale, radius, enabled);
  }

  showStatus(status) {
    byId('status').textContent = statusText(status);
    byId('activity').dataset.phase = status.phase;
    this.failure = status.phase === 'failed' ? status.message : '';
    this.#showFault();
    // The running figures would drown a screen reader: it is told of the ends only.
    if (['done', 'waiting'].includes(status.phase)) byId('announcement').textContent = statusText(status);
  }

  /** A message over the picture, '' for none; a failure of the rendering itself goes before it. */
  showProblem(text) {
    this.notice = text;
    this.#showFault();
  }

  #showFault() {
    const text = this.failure || this.notice;
    const problem = byId('problem');
    if (problem.textContent !== text) problem.textContent = text;
    problem.hidden = text === '';
  }

  /** Asks for a key until one is given that can be sent; `note` says why. Calls `onKey(key)`. */
  askKey(note, onKey) {
    const [dialog, input] = [byId('key-dialog'), byId('key')];
    if (dialog.open) return; // somebody is at it
    byId('key-note').textContent = note;
    input.value = '';
    dialog.oncancel = (event) => event.preventDefault(); // without a key there is nothing to see
    dialog.onsubmit = (event) => {
      const key = input.value.trim();
      if (isSendable(key)) return onKey(key);
      event.preventDefault();
      byId('key-note').textContent = 'A key is made of letters, digits and signs, without blanks.';
    };
    dialog.showModal();
    input.focus();
  }

  /** What lies under a point (x, y in pixels of the picture): a hit, null for nothing, or undefined to show none. */
  showPoint(hit, x, y) {
    byId('marker').hidden = hit === undefined;
    byId('marker').style.translate = `${x}px ${y}px`;
    byId('point-hint').hidden = Boolean(hit);
    byId('point').hidden = !hit;
    byId('point-hint').textContent =
      hit === null ? 'No object of the scene there.' : 'Click the picture to see what is there.';
    if (!hit) return;
    byId('point').replaceChildren(
      ...hitRows(hit).flatMap(([name, text]) => {
        const [term, value] = [document.createElement('dt'), document.createElement('dd')];
        term.textContent = name;
        value.textContent = text;
        return [term, value];
      }),
    );
  }
}

/** Makes the link `anchor` save a canvas as a PNG; it and the name are made when it is clicked. */
export function offerDownload(anchor, picture, fileName) {
  anchor.href = '#';
  anchor.removeAttribute('aria-disabled');
  anchor.addEventListener('click', (event) => {
    event.preventDefault();
    picture().toBlob((blob) => save(blob, fileName()), 'image/png');
  });
}

export function save(blob, fileName) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = fileName;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
