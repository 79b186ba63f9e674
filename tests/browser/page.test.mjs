// The page in a real browser, on the real server:
//   node tests/browser/page.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER
import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { parseArgs } from 'node:util';

import { openBrowser, watchConsole } from './browser.mjs';
import { startFlakyProxy } from './flaky_proxy.mjs';
import { blockMeans, changedShare, contrast, waitForSamples } from './picture.mjs';
import { makeRoot, roundMesh, startServer } from '../support/server.mjs';

const { values: paths } = parseArgs({
  options: { chamferd: { type: 'string' }, chamferprep: { type: 'string' }, data: { type: 'string' } },
});
for (const name of ['chamferd', 'chamferprep', 'data']) {
  if (!paths[name]) throw new Error(`--${name} is missing`);
}

const SAMPLES = 8;
const SIZE = { width: 640, height: 420 };

let root;
let server;
let browser;
let page;
let faults;

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data);
  server = await startServer(paths.chamferd, root.root);
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
  root?.remove();
});

beforeEach(async () => {
  page = await browser.newPage({ viewport: SIZE, hasTouch: true });
  faults = watchConsole(page);
});

afterEach(async () => {
  await page.close();
  assert.deepEqual(faults, []);
});

async function open(hash) {
  await page.goto(`${server.url}/${hash}`);
  await waitForSamples(page, SAMPLES);
}

/** Does something to the view, waits for the new picture and returns it. */
async function pictureAfter(action) {
  const before = await page.evaluate(() => document.getElementById('status').textContent);
  await action();
  await page.waitForFunction((text) => document.getElementById('status').textContent !== text, before);
  await page.waitForTimeout(400); // a moved view counts as moving for a moment
  await waitForSamples(page, SAMPLES);
  return blockMeans(page);
}

const setRadius = (position) =>
  page.locator('#radius').evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    slider.dispatchEvent(new Event('change', { bubbles: true }));
  }, position);

const middleOfPicture = async () => {
  const box = await page.locator('#picture').boundingBox();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
};

const addressAfter = (word) => page.waitForFunction((part) => location.hash.includes(part), word);

test('without a link the page opens a scene file and shows a picture', async () => {
  await open('');
  assert.ok(contrast(await blockMeans(page)) > 15);
  assert.match(await page.title(), /^(blocks|dice|room) – Chamfer$/);
  assert.match(await page.locator('#status').textContent(), /\d+ of \d+ samples · [\d.]+ s · [\d.]+ % of rays/);
});

test('every bundled scene can be picked and is neither empty nor black', async () => {
  await open('');
  const names = await page.locator('#scene option').evaluateAll((options) => options.map((option) => option.value));
  for (const expected of ['blocks', 'dice', 'room', 'solids/cube', 'solids/dodecahedron', 'bricks/brick-2x4']) {
    assert.ok(names.includes(expected), `${expected} is not among ${names}`);
  }
  for (const name of ['dice', 'room', 'blocks']) {
    const picture = await pictureAfter(() => page.locator('#scene').selectOption(name));
    assert.ok(contrast(picture) > 10, `${name} has a contrast of ${contrast(picture)}`);
  }
});

test('the radius slider changes the picture, and back', async () => {
  await open('#scene=solids/cube');
  const own = await blockMeans(page);
  const round = await pictureAfter(() => setRadius(1000));
  assert.ok(changedShare(own, round) > 0.02, `only ${changedShare(own, round)} of the picture has changed`);
  assert.ok(await page.evaluate(() => Number(document.getElementById('radius-text').textContent) > 0.49));
  const back = await pictureAfter(() => page.locator('#reset-radius').click());
  assert.ok(changedShare(own, back) < 0.005, `${changedShare(own, back)} of the picture is not as it was`);
});

test('none and analytic are two pictures', async () => {
  await open('#scene=solids/cube&radius=0.3');
  const analytic = await blockMeans(page);
  const none = await pictureAfter(() => page.locator('input[value="none"]').check({ force: true }));
  assert.ok(changedShare(analytic, none) > 0.01, `only ${changedShare(analytic, none)} of the picture has changed`);
  assert.match(await page.locator('#status').textContent(), / 0\.0 % of rays/);
  assert.ok(await page.locator('#radius').isDisabled());
  const again = await pictureAfter(() => page.locator('input[value="analytic"]').check({ force: true }));
  assert.ok(changedShare(analytic, again) < 0.005);
});

test('dragging orbits, the wheel zooms, and the address keeps the view', async () => {
  await open('#scene=dice');
  const own = await blockMeans(page);
  const { x, y } = await middleOfPicture();
  const turned = await pictureAfter(async () => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 90, y - 30, { steps: 6 });
    await page.mouse.up();
  });
  assert.ok(changedShare(own, turned) > 0.1);
  await addressAfter('camera=');
  const near = await pictureAfter(() => page.mouse.wheel(0, -600));
  assert.ok(changedShare(turned, near) > 0.1);

  await page.waitForTimeout(400); // the address follows the view with a small delay
  const link = await page.evaluate(() => location.hash);
  await page.goto('about:blank');
  await open(link);
  assert.ok(changedShare(near, await blockMeans(page)) < 0.01);
});

test('one finger orbits, two fingers zoom', async () => {
  await open('#scene=dice');
  const own = await blockMeans(page);
  const { x, y } = await middleOfPicture();
  const touch = await page.context().newCDPSession(page);
  const send = (type, points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  const turned = await pictureAfter(async () => {
    await send('touchStart', [{ x, y }]);
    for (let i = 1; i <= 5; i++) await send('touchMove', [{ x: x + 15 * i, y }]);
    await send('touchEnd', []);
  });
  assert.ok(changedShare(own, turned) > 0.1);
  const near = await pictureAfter(async () => {
    const fingers = (gap) => [{ x: x - gap, y, id: 1 }, { x: x + gap, y, id: 2 }];
    await send('touchStart', fingers(20));
    for (let gap = 25; gap <= 60; gap += 5) await send('touchMove', fingers(gap));
    await send('touchEnd', []);
  });
  assert.ok(changedShare(turned, near) > 0.1);
});

test('the keyboard turns the view, and Home brings it back', async () => {
  await open('#scene=solids/cube');
  const own = await blockMeans(page);
  await page.locator('#picture').focus();
  const turned = await pictureAfter(async () => {
    for (let i = 0; i < 5; i++) await page.keyboard.press('ArrowLeft');
  });
  assert.ok(changedShare(own, turned) > 0.03);
  const home = await pictureAfter(() => page.keyboard.press('Home'));
  assert.ok(changedShare(own, home) < 0.005);
});

test('a click says what is there', async () => {
  // Straight at the middle of the cube's front face, then at the same place of a cube that is all but a ball.
  await open('#scene=solids/cube&camera=0,-4,0,0,0,0,0,0,1,30');
  const { x, y } = await middleOfPicture();
  await page.mouse.click(x + 20, y - 20);
  await page.locator('#point').waitFor();
  const flat = await page.locator('#point').textContent();
  assert.match(flat, /flat: an unrounded part.*Normal0\.0000, -1\.0000, 0\.0000/);
  await pictureAfter(() => setRadius(1000));
  assert.ok(await page.locator('#point').isHidden());
  await page.mouse.click(x + 20, y - 20);
  await page.locator('#point').waitFor();
  assert.match(await page.locator('#point').textContent(), /sphere: a rounded corner/);
});

test('a link to a view sets every control', async () => {
  await open('#scene=solids/octahedron&radius=0.2&rounding=none');
  assert.equal(await page.locator('#scene').inputValue(), 'solids/octahedron');
  assert.equal(await page.locator('#radius-text').textContent(), '0.2');
  assert.ok(await page.locator('input[value="none"]').isChecked());
});

test('a link to a scene that is not there says so and shows another one', async () => {
  await page.goto(`${server.url}/#scene=no/such`);
  await page.locator('#problem').waitFor();
  assert.match(await page.locator('#problem').textContent(), /no scene “no\/such”/);
  await waitForSamples(page, 1);
});

test('the picture can be saved as a PNG', async () => {
  await open('#scene=solids/cube');
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#download').click()]);
  assert.equal(download.suggestedFilename(), 'solids-cube-analytic.png');
  const bytes = readFileSync(await download.path());
  assert.equal(bytes.subarray(1, 4).toString('latin1'), 'PNG');
  const canvas = await page.evaluate(() => {
    const { width, height } = document.getElementById('picture');
    return [width, height];
  });
  assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], canvas);
});

test('a server with keys is asked with one, which the tab keeps', async () => {
  const file = join(root.root, 'keys.txt');
  writeFileSync(file, '0123456789abcdef\n');
  const guarded = await startServer(paths.chamferd, root.root, 0, ['--key-file', file]);
  try {
    await page.goto(`${guarded.url}/#scene=solids/cube`);
    const dialog = page.locator('#key-dialog');
    await dialog.waitFor();
    await page.keyboard.press('Escape');
    assert.ok(await dialog.isVisible());
    const give = async (key) => {
      await page.locator('#key').fill(key);
      await page.keyboard.press('Enter');
    };
    await give('two words');
    assert.match(await page.locator('#key-note').textContent(), /without blanks/);
    await give('fedcba9876543210');
    await page.waitForFunction(() => document.getElementById('key-note').textContent.includes('not one of'));
    await give('0123456789abcdef');
    await waitForSamples(page, SAMPLES);
    assert.ok(await dialog.isHidden());
    assert.ok(contrast(await blockMeans(page)) > 5);
    await page.reload();
    await waitForSamples(page, SAMPLES);
    assert.ok(await dialog.isHidden());
    assert.ok(!(await page.evaluate(() => location.href)).includes('0123456789abcdef'));
    // Another key from now on: it is asked for while the picture is there.
    await guarded.stop();
    writeFileSync(file, 'aaaabbbbccccdddd\n');
    const changed = await startServer(paths.chamferd, root.root, guarded.port, ['--key-file', file]);
    try {
      await page.locator('input[value="none"]').check({ force: true });
      await dialog.waitFor();
      await give('aaaabbbbccccdddd');
      await waitForSamples(page, SAMPLES);
    } finally {
      await changed.stop();
    }
  } finally {
    await guarded.stop();
  }
  // The browser itself reports refusals, and the 503 of a draining server.
  const expected = /status of (401|403|503)|ERR_CONNECTION_REFUSED|ERR_CONNECTION_RESET/;
  const others = faults.filter((fault) => !expected.test(fault));
  faults.length = 0;
  assert.deepEqual(others, []);
});

test('the page says that the server is away, and goes on when it is back', async () => {
  await open('#scene=solids/cube');
  const { port } = server;
  assert.equal(await server.stop(), 0);
  await page.locator('input[value="none"]').check({ force: true });
  await page.waitForFunction(() => document.getElementById('status').textContent.includes('does not answer'));
  server = await startServer(paths.chamferd, root.root, port);
  await waitForSamples(page, SAMPLES);
  // The browser itself reports connections that were refused, and the 503 of a draining server; no more may be wrong.
  const expected = /ERR_CONNECTION_REFUSED|ERR_CONNECTION_RESET|ERR_EMPTY_RESPONSE|status of 503/;
  const others = faults.filter((fault) => !expected.test(fault));
  faults.length = 0;
  assert.deepEqual(others, []);
});

/** Opens the page through a proxy that does `fault` to answers, and lets `steps` go on from there. */
async function throughFlakyProxy(hash, fault, steps) {
  const proxy = await startFlakyProxy(server.port, fault);
  try {
    await page.goto(`${proxy.url}/${hash}`);
    await steps();
  } finally {
    await page.goto('about:blank');
    await proxy.stop();
  }
  // The browser itself reports what was cut short; no more may be wrong.
  const expected = /ERR_CONTENT_LENGTH_MISMATCH|ERR_INCOMPLETE_CHUNKED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_(RESET|CLOSED)/;
  const others = faults.filter((text) => !expected.test(text));
  faults.length = 0;
  assert.deepEqual(others, []);
}

const saysInStatus = (text) =>
  page.waitForFunction((part) => document.getElementById('status').textContent.includes(part), text);
const saysInProblem = (text) =>
  page.waitForFunction((part) => document.getElementById('problem').textContent.includes(part), text);

test('an answer cut short is told and asked for again, whatever it is', async () => {
  const cuts = { '/v1/scenes': 1, '/v1/scenes/solids%2Fcube': 1, '/tiles/': 1, '/rays': 1 };
  const seen = [];
  const fault = (path) => {
    const kind = Object.keys(cuts).find((part) => (part.endsWith('/') || part === '/rays' ? path.includes(part) : path === part));
    if (!kind || cuts[kind]-- <= 0) return undefined;
    seen.push(kind);
    return 'cut';
  };
  await throughFlakyProxy('#scene=solids/cube&camera=0,-4,0,0,0,0,0,0,1,30', fault, async () => {
    await saysInProblem('cut short');
    await saysInStatus('cut short. Trying again');
    await waitForSamples(page, SAMPLES);
    assert.ok(await page.locator('#problem').isHidden());
    const { x, y } = await middleOfPicture();
    await page.mouse.click(x, y);
    await saysInProblem('cut short. Trying again');
    await page.locator('#point').waitFor();
    assert.ok(await page.locator('#problem').isHidden());
  });
  assert.deepEqual(seen.sort(), Object.keys(cuts).sort());
});

test('a slow answer does not override a later pick', async () => {
  const slow = /^\/v1\/scenes\/solids%2Fdodecahedron$/;
  let held = 0;
  const fault = (path) => (slow.test(path) ? (++held, 2500) : undefined);
  await throughFlakyProxy('#scene=solids/cube', fault, async () => {
    await waitForSamples(page, 1);
    await page.locator('#scene').selectOption('solids/dodecahedron');
    await page.waitForTimeout(200);
    await page.locator('#scene').selectOption('solids/octahedron');
    await page.waitForFunction(() => document.title.startsWith('solids/octahedron'));
    await page.waitForTimeout(3000);
    assert.match(await page.title(), /^solids\/octahedron/);
    assert.equal(await page.locator('#scene').inputValue(), 'solids/octahedron');

    // A rounding chosen while a scene is on its way stays chosen, and the list keeps what was picked.
    await page.locator('#scene').selectOption('solids/dodecahedron');
    await page.locator('input[value="none"]').check({ force: true });
    assert.equal(await page.locator('#scene').inputValue(), 'solids/dodecahedron');
    await page.waitForFunction(() => document.title.startsWith('solids/dodecahedron'));
    assert.ok(await page.locator('input[value="none"]').isChecked());
    await addressAfter('rounding=none');
  });
  assert.equal(held, 2);
});

test('scenes come and go without reloading the page', async () => {
  await open('#scene=solids/cube');
  const options = () => page.locator('#scene option').evaluateAll((list) => list.map(({ value }) => value));
  const files = ['obj', 'obj.chamfer'].map((extension) => [
    join(root.root, `solids/cube.${extension}`),
    join(root.root, `new/late.${extension}`),
  ]);
  assert.ok(!(await options()).includes('new/late'));
  mkdirSync(join(root.root, 'new'));
  for (const [from, to] of files) copyFileSync(from, to);
  await page.waitForFunction(() =>
    [...document.querySelectorAll('#scene option')].some(({ value, disabled }) => value === 'new/late' && !disabled),
  );
  assert.equal(await page.locator('#scene').inputValue(), 'solids/cube');
  await page.locator('#scene').selectOption('new/late');
  await page.waitForFunction(() => document.title.startsWith('new/late'));
  await waitForSamples(page, 1);
  rmSync(join(root.root, 'new'), { recursive: true });
  await saysInProblem('no longer on the server');
  assert.ok(!(await options()).includes('new/late'));
});

/** OBJ of a post: a wide foot and a thin shaft, their corners (right, back, up) as `place` puts them into x, y, z. */
function postObj(place) {
  const box = (first, [width, depth, low, high]) => {
    const corners = Array.from({ length: 8 }, (_, i) =>
      place((i & 1 ? 1 : -1) * width, (i & 2 ? 1 : -1) * depth, i & 4 ? high : low).join(' '));
    const faces = ['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'];
    const numbered = faces.map((face) => face.replace(/\d/g, (v) => Number(v) + first));
    return [...corners.map((corner) => `v ${corner}`), ...numbered.map((face) => `f ${face}`)];
  };
  return `${[...box(0, [0.6, 0.4, 0, 0.2]), ...box(8, [0.1, 0.1, 0.2, 3])].join('\n')}\n`;
}

test('a mesh whose y axis points up is turned upright, and the link says so', async () => {
  mkdirSync(join(root.root, 'posts'));
  const meshes = [['y', (right, back, up) => [right, up, -back]], ['z', (right, back, up) => [right, back, up]]];
  const files = meshes.map(([name, place]) => {
    const file = join(root.root, `posts/${name}.obj`);
    writeFileSync(file, postObj(place));
    return file;
  });
  roundMesh(paths.chamferprep, files, '0.03');
  try {
    await open('');
    await page.waitForFunction(() => {
      const listed = [...document.querySelectorAll('#scene option:enabled')].map(({ value }) => value);
      return listed.includes('posts/y') && listed.includes('posts/z');
    });
    assert.ok(await page.locator('#up-axis').isHidden(), 'a scene file says itself what is up');
    const upright = await pictureAfter(() => page.locator('#scene').selectOption('posts/z'));
    assert.ok(await page.locator('input[name="up"][value="z"]').isChecked());
    const lying = await pictureAfter(() => page.locator('#scene').selectOption('posts/y'));
    assert.ok(changedShare(upright, lying) > 0.05);

    const turned = await pictureAfter(() => page.locator('input[name="up"][value="y"]').check({ force: true }));
    assert.ok(changedShare(upright, turned) < 0.005, `${changedShare(upright, turned)} is not as it is upright`);
    assert.match(await page.title(), /^posts\/y/);
    await addressAfter('up=y');
    await page.waitForTimeout(6000); // the list of scenes is asked for again, and changes nothing
    assert.ok(await page.locator('input[name="up"][value="y"]').isChecked());

    const link = await page.evaluate(() => location.hash);
    await page.goto('about:blank');
    await open(link);
    assert.ok(changedShare(upright, await blockMeans(page)) < 0.005);
    const again = await pictureAfter(() => page.locator('input[name="up"][value="z"]').check({ force: true }));
    assert.ok(changedShare(lying, again) < 0.005);
    await page.waitForFunction(() => !location.hash.includes('up='));
  } finally {
    rmSync(join(root.root, 'posts'), { recursive: true });
  }
});

test('a scene whose file has changed is taken up, with the view', async () => {
  await open('#scene=solids/octahedron&camera=0,-4,1,0,0,0,0,0,1,30');
  const file = join(root.root, 'solids/octahedron.obj.chamfer');
  const before = readFileSync(file);
  const [own, picture] = [await page.locator('#radius-text').textContent(), await blockMeans(page)];
  try {
    roundMesh(paths.chamferprep, join(root.root, 'solids/octahedron.obj'), '0.3');
    await page.waitForFunction((text) => document.getElementById('radius-text').textContent !== text, own);
    assert.equal(await page.locator('#radius-text').textContent(), '0.3');
    await waitForSamples(page, SAMPLES);
    assert.ok(changedShare(picture, await blockMeans(page)) > 0.005);
    await addressAfter('camera=0,-4,1,');
  } finally {
    writeFileSync(file, before);
  }
  // The browser itself reports tiles that were asked for under the old id.
  const others = faults.filter((fault) => !/status of 404/.test(fault));
  faults.length = 0;
  assert.deepEqual(others, []);
});
