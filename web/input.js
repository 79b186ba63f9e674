// Mouse, touch, pen and keyboard on the picture, turned into what they mean: turn, shift, zoom, inspect.

const TURN_PER_HEIGHT = Math.PI; // a drag over the whole height of the picture
const WHEEL_ZOOM = 0.0015; // per pixel of wheel travel
const LINE_PIXELS = 24; // wheels that count lines
const KEY_TURN = (6 * Math.PI) / 180;
const KEY_SHIFT = 0.06;
const KEY_ZOOM = 1.12;
const CLICK_PIXELS = 5; // a pointer that moved less has clicked

/**
 * Listens on `element`. `actions`: turn(azimuth, elevation) in radians, shift(dx, dy) in shares of the element's height,
 * zoom(factor on the distance), inspect(x, y) in pixels of the element, home().
 */
export function listen(element, actions) {
  const pointers = new Map();
  let travelled = 0;

  element.addEventListener('pointerdown', (event) => {
    if (event.pointerType === 'mouse' && event.button > 1) return;
    element.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });

  element.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const now = { x: event.clientX, y: event.clientY };
    const [dx, dy] = [now.x - last.x, now.y - last.y];
    travelled += Math.hypot(dx, dy);
    if (travelled < CLICK_PIXELS) return;
    const height = element.clientHeight;
    if (pointers.size >= 2) {
      pinch(event.pointerId, now, height);
    } else if (event.shiftKey || (event.buttons & 4) !== 0) {
      actions.shift(dx / height, dy / height);
    } else {
      actions.turn((-dx / height) * TURN_PER_HEIGHT, (dy / height) * TURN_PER_HEIGHT);
    }
    pointers.set(event.pointerId, now);
  });

  /** One of two fingers has moved: their distance zooms, their middle shifts. */
  function pinch(id, now, height) {
    const other = [...pointers].find(([key]) => key !== id)[1];
    const last = pointers.get(id);
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(now.x - other.x, now.y - other.y);
    if (before > 0 && after > 0) actions.zoom(before / after);
    actions.shift((now.x - last.x) / 2 / height, (now.y - last.y) / 2 / height);
  }

  const release = (event) => {
    const clicked = event.type === 'pointerup' && pointers.size === 1 && travelled < CLICK_PIXELS;
    if (!pointers.delete(event.pointerId) || !clicked) return;
    const box = element.getBoundingClientRect();
    actions.inspect(event.clientX - box.left, event.clientY - box.top);
  };
  element.addEventListener('pointerup', release);
  element.addEventListener('pointercancel', release);

  element.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PIXELS : 1);
      actions.zoom(Math.exp(Math.max(-300, Math.min(300, pixels)) * WHEEL_ZOOM));
    },
    { passive: false },
  );

  element.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const action = keyAction(event.key, event.shiftKey, element, actions);
    if (!action) return;
    event.preventDefault();
    action();
  });
}

function keyAction(key, shifted, element, actions) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (arrows[key]) {
    const [x, y] = arrows[key];
    if (shifted) return () => actions.shift(x * KEY_SHIFT, y * KEY_SHIFT);
    return () => actions.turn(x * KEY_TURN, -y * KEY_TURN);
  }
  switch (key) {
    case '+':
    case '=':
      return () => actions.zoom(1 / KEY_ZOOM);
    case '-':
    case '_':
      return () => actions.zoom(KEY_ZOOM);
    case 'Home':
      return () => actions.home();
    case 'Enter':
      return () => actions.inspect(element.clientWidth / 2, element.clientHeight / 2);
    default:
      return null;
  }
}
