// The divider of two pictures that lie over each other: A is to be seen left of it, B right of it.

const STEP = 1; // per cent, of an arrow key
const LEAP = 10; // with Shift, or a page key

/** Where a key moves the divider from `split`, per cent; null where it does not. */
export function splitAfter(key, split, isShifted) {
  const step = isShifted ? LEAP : STEP;
  const moved = {
    ArrowLeft: split - step, ArrowDown: split - step, ArrowRight: split + step, ArrowUp: split + step,
    PageDown: split - LEAP, PageUp: split + LEAP, Home: 0, End: 100,
  }[key];
  return moved === undefined ? null : Math.max(0, Math.min(100, Math.round(moved * 10) / 10));
}

export class Divider {
  /** `element`: the slider, in its box; `onMove(split)`, in per cent of the box's width. */
  constructor(element, onMove) {
    this.element = element;
    this.split = 50;
    element.addEventListener('pointerdown', (event) => {
      if (event.pointerType === 'mouse' && event.button !== 0) return;
      event.preventDefault();
      element.focus();
      element.setPointerCapture(event.pointerId);
      // The divider does not jump to the pointer when it is taken beside its middle.
      const box = element.getBoundingClientRect();
      this.grip = event.clientX - (box.left + box.width / 2);
    });
    element.addEventListener('pointermove', (event) => {
      if (!element.hasPointerCapture(event.pointerId)) return;
      const box = element.parentElement.getBoundingClientRect();
      const share = (event.clientX - this.grip - box.left) / box.width;
      onMove(Math.max(0, Math.min(100, Math.round(share * 1000) / 10)));
    });
    element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const split = splitAfter(event.key, this.split, event.shiftKey);
      if (split === null) return;
      event.preventDefault();
      onMove(split);
    });
  }

  show(split) {
    this.split = split;
    this.element.parentElement.style.setProperty('--split', `${split}%`);
    this.element.setAttribute('aria-valuenow', String(Math.round(split)));
    this.element.setAttribute('aria-valuetext', `A left of ${Math.round(split)} %, B right of it`);
  }
}
