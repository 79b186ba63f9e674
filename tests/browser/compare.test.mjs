// Two settings compared on the page, in a real browser, on the real server:
//   node tests/browser/compare.test.mjs --chamferd PATH --chamferprep PATH --data FOLDER
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { parseArgs } from 'node:util';

import { openBrowser, watchConsole } from './browser.mjs';
import { waitForSamples } from './picture.mjs';
import { makeRoot, startServer } from '../support/server.mjs';

const { values: paths } = parseArgs({
  options: { chamferd: { type: 'string' }, chamferprep: { type: 'string' }, data: { type: 'string' }, web: { type: 'string' } },
});
for (const name of ['chamferd', 'chamferprep', 'data']) {
  if (!paths[name]) throw new Error(`--${name} is missing`);
}

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const DESKTOP = { viewport: { width: 720, height: 460 }, hasTouch: true };
const PHONE = { viewport: { width: 360, height: 740 }, deviceScaleFactor: 1, hasTouch: true, isMobile: true };
/** `--web DIR`: this page instead of the one that is built in. */
const WEB = paths.web ? ['--web', paths.web] : [];
const CUBE = '#scene=solids/cube&camera=0,-4,0,0,0,0,0,0,1,30';
const COMPARED = `${CUBE}&radius=0.4&compare=slider&b-rounding=none`;

let root;
let jobs;
let server;
let browser;
let page;
let faults;

before(async () => {
  root = makeRoot(paths.chamferprep, paths.data, []);
  jobs = mkdtempSync(join(tmpdir(), 'chamfer-jobs-'));
  server = await startServer(paths.chamferd, root.root, 0, ['--jobs', jobs, ...WEB]);
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
  root?.remove();
  if (jobs) rmSync(jobs, { recursive: true, force: true });
});

beforeEach(() => newPage(DESKTOP));

afterEach(async () => {
  await page.context().close();
  assert.deepEqual(faults, []);
});

async function newPage(options) {
  await page?.context().close();
  page = await (await browser.newContext(options)).newPage();
  faults = watchConsole(page);
}

async function open(hash, samples = 4, { url } = server) {
  await page.goto('about:blank');
  await page.goto(`${url}/${hash}`);
  await waitForSamples(page, samples);
}

const slider = () => page.getByRole('slider', { name: 'Divider between A and B' });
const choose = (mode) => page.locator(`input[name="compare"][value="${mode}"]`).check({ force: true });

/** Mean colour of what is seen about a place of the picture's stage, shares of its width and height. */
async function colorAt(u, v, radius = 5) {
  const png = (await page.locator('#view').screenshot()).toString('base64');
  return page.evaluate(async ([data, x, y, r]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const bytes = context.getImageData(Math.round(x * image.width) - r, Math.round(y * image.height) - r, 2 * r, 2 * r).data;
    return [0, 1, 2].map((c) => bytes.reduce((sum, value, i) => (i % 4 === c ? sum + value : sum), 0) / (4 * r * r));
  }, [png, u, v, radius]);
}
const apart = (p, q) => Math.max(...p.map((value, i) => Math.abs(value - q[i])));

/** Where the cube's front face is seen by its corner, which a radius of 0.4 takes away: left and right of the middle. */
async function corners() {
  const { width, height } = await page.locator('#picture').boundingBox();
  const fit = Math.min(1, width / height / (4 / 3)); // the view widens in narrow pictures
  const half = (0.47 * fit) / 3.5 / Math.tan(Math.PI / 12); // of half of the height
  return { left: 0.5 - (half * height) / width / 2, right: 0.5 + (half * height) / width / 2, top: 0.5 - half / 2 };
}

test('compare is turned on, the divider goes by mouse, touch and keys, and each side shows its own setting', async () => {
  await open(`${CUBE}&radius=0.4`);
  const { left, right, top } = await corners();
  const [rounded, background] = [await colorAt(left, top), await colorAt(0.05, 0.1)];
  await choose('slider');
  await waitForSamples(page, 4);
  assert.equal(await page.locator('#rounding-b').inputValue(), 'none');
  assert.match(await page.locator('#side-a').textContent(), /analytic, r 0\.4/);
  assert.match(await page.locator('#side-b').textContent(), /no rounding/);
  assert.ok(apart(await colorAt(left, top), rounded) < 12, 'left of the divider is A');

  await slider().focus();
  await page.keyboard.press('Home');
  assert.equal(await slider().getAttribute('aria-valuenow'), '0');
  const sharp = await colorAt(left, top);
  assert.ok(apart(sharp, rounded) > 25, `${sharp} and ${rounded} on ${background}`);
  const sharpRight = await colorAt(right, top);
  await page.keyboard.press('End');
  assert.ok(apart(await colorAt(left, top), rounded) < 12);
  assert.ok(apart(await colorAt(right, top), sharpRight) > 25);
  for (const key of ['PageDown', 'Shift+ArrowLeft', 'ArrowLeft']) await page.keyboard.press(key);
  assert.equal(await slider().getAttribute('aria-valuenow'), '79');
  assert.equal(await slider().getAttribute('aria-valuetext'), 'A left of 79 %, B right of it');

  const box = await page.locator('#view').boundingBox();
  const before = await page.evaluate(() => document.getElementById('status').textContent.match(/(\d+) of/)[1]);
  const handle = await slider().boundingBox();
  await page.mouse.move(handle.x + handle.width / 2, handle.y + handle.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, handle.y + 20, { steps: 5 });
  await page.mouse.up();
  assert.ok(Math.abs(Number(await slider().getAttribute('aria-valuenow')) - 50) <= 1);
  assert.ok(apart(await colorAt(left, top), rounded) < 12);
  assert.ok(apart(await colorAt(right, top), sharpRight) < 12);
  // Neither the view nor the picture began anew.
  const [, samples] = (await page.locator('#status').textContent()).match(/(\d+) of/);
  assert.ok(Number(samples) >= Number(before));
  const seen = await slider().boundingBox();
  assert.ok(Math.abs(seen.x + seen.width / 2 - (box.x + box.width / 2)) < 2);
});

test('a link opens the comparison as it was', async () => {
  await open(COMPARED);
  await page.locator('#rounding-b').selectOption('mesh');
  await page.locator('#amount-b').fill('3');
  await page.locator('#amount-b').press('Enter');
  await slider().focus();
  await page.keyboard.press('Shift+ArrowRight');
  await page.locator('#scene-b').selectOption('solids/dodecahedron');
  await page.waitForFunction(() => /b-scene=.*b-rounding=mesh:3/.test(location.hash) && location.hash.includes('split=60'));
  const link = await page.evaluate(() => location.hash);
  await open(link);
  assert.equal(await page.locator('#scene-b').inputValue(), 'solids/dodecahedron');
  assert.equal(await page.locator('#rounding-b').inputValue(), 'mesh');
  assert.equal(await page.locator('#amount-b').inputValue(), '3');
  assert.equal(await slider().getAttribute('aria-valuenow'), '60');
  assert.ok(await page.locator('input[value="slider"]').isChecked());
  await page.waitForFunction((wanted) => location.hash === wanted, link);
});

test('only the side that is changed is rendered anew, by the same samples', async () => {
  const tiles = [];
  page.on('request', (request) => {
    const found = request.url().match(/tiles\/(\w+)\/([\d,]+)\/([\d-]+).*rounding=([\w:]+)/);
    if (found) tiles.push(found.slice(1).join(' '));
  });
  await open(COMPARED, 4);
  const size = await page.evaluate(() => `${document.getElementById('picture').width}x${document.getElementById('picture').height}`);
  const full = () => tiles.filter((tile) => tile.startsWith(size));
  const sides = ['analytic', 'none'].map((word) => full().filter((tile) => tile.endsWith(word)).map((tile) => tile.replace(/ \S+$/, '')));
  const common = Math.min(...sides.map((side) => side.length));
  assert.ok(common >= 3 && Math.abs(sides[0].length - sides[1].length) <= 1, `${sides.map((side) => side.length)}`);
  assert.deepEqual(sides[0].slice(0, common), sides[1].slice(0, common));

  tiles.length = 0;
  await page.locator('#rounding-b').selectOption('bevel');
  await page.waitForTimeout(300);
  await waitForSamples(page, 4);
  const kept = full().filter((tile) => / 0-1 /.test(tile));
  assert.ok(kept.length > 0 && kept.every((tile) => tile.endsWith('bevel:16')), kept.join('\n'));
});

test('the difference is dark where both are the same and bright where they are not, with a scale', async () => {
  await open(`${COMPARED.replace('slider', 'difference')}&b-radius=0.4`);
  assert.ok(await slider().isHidden());
  const { left, top } = await corners();
  const [corner, face] = [await colorAt(left, top), await colorAt(0.5, 0.5)];
  const brightness = (color) => color.reduce((sum, value) => sum + value, 0);
  assert.ok(brightness(corner) > 150 && brightness(face) < 60, `${corner} and ${face}`);
  const ticks = await page.locator('#scale-ticks span').allTextContents();
  assert.equal(ticks.length, 4);
  assert.ok(Number(ticks[3]) === 1000 * Number(ticks[0].replace('≤ ', '')), ticks.join());
  await page.locator('#rounding-b').selectOption('analytic');
  await page.waitForFunction(() => document.getElementById('scale-note').textContent === 'No value differs.');
  assert.ok(brightness(await colorAt(left, top)) < 12);
});

test('side by side each has a whole picture, and a click says what is there', async () => {
  await open(COMPARED.replace('slider', 'beside'));
  const [a, b] = [await page.locator('#picture').boundingBox(), await page.locator('#picture-b').boundingBox()];
  const beside = Math.abs(a.x + a.width - b.x) < 2 && a.height === b.height;
  const below = Math.abs(a.y + a.height - b.y) < 2 && a.width === b.width;
  assert.ok(beside || below);
  // By an edge of the front face: rounded in A, flat in B.
  const { top } = await corners();
  for (const [box, feature] of [[a, /cylinder/], [b, /flat/]]) {
    const y = box.y + box.height * (top + 0.03);
    await page.mouse.click(box.x + box.width / 2, y);
    await page.waitForFunction((word) => document.getElementById('point').textContent.includes(word), feature.source);
  }
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#download').click()]);
  assert.equal(download.suggestedFilename(), 'solids-cube-analytic-beside.png');
});

test('swapping turns the sides around', async () => {
  await open(COMPARED);
  const { left, top } = await corners();
  const rounded = await colorAt(left, top);
  await page.locator('#swap').click();
  assert.ok(await page.locator('input[name="rounding"][value="none"]').isChecked());
  assert.equal(await page.locator('#rounding-b').inputValue(), 'analytic');
  assert.ok(apart(await colorAt(left, top), rounded) > 25);
  assert.equal(await page.locator('#radius-b-text').textContent(), '0.4');
});

test('a comparison job is started, followed, and its report opens', async () => {
  await open(COMPARED, 2);
  await page.locator('#job-size').selectOption('4');
  await page.getByRole('button', { name: 'Start a comparison' }).click();
  await page.locator('#job').waitFor();
  assert.match(await page.locator('#job-name').textContent(), /^solids\/cube: analytic, radius 0\.4 against no rounding$/);
  await page.waitForFunction(() => document.getElementById('job-state').textContent === 'Differs', null, { timeout: 90_000 });
  assert.match(await page.locator('#job-reason').textContent(), /\w/);
  const [report] = await Promise.all([page.context().waitForEvent('page'), page.getByRole('link', { name: 'Open report' }).click()]);
  const reportFaults = watchConsole(report);
  await report.locator('.case').first().waitFor();
  assert.match(await report.title(), /^differs/);
  assert.match(await report.locator('#case-1').textContent(), /radius=0\.4/);
  assert.deepEqual(reportFaults, []);
});

test('a job is cancelled', async () => {
  await open(COMPARED.replace('none', 'bevel:64'), 1);
  await page.getByRole('button', { name: 'Start a comparison' }).click();
  await page.getByRole('button', { name: 'Cancel' }).click();
  await page.waitForFunction(() => document.getElementById('job-state').textContent === 'Cancelled');
  assert.ok(await page.locator('#job-cancel').isHidden());
});

test('with a key the report is saved, since a link cannot carry one', async () => {
  const file = join(root.root, 'keys.txt');
  writeFileSync(file, '0123456789abcdef\n');
  const folder = mkdtempSync(join(tmpdir(), 'chamfer-jobs-'));
  const guarded = await startServer(paths.chamferd, root.root, 0, ['--key-file', file, '--jobs', folder, ...WEB]);
  try {
    await page.goto(`${guarded.url}/${COMPARED}`);
    await page.locator('#key').fill('0123456789abcdef');
    await page.keyboard.press('Enter');
    await waitForSamples(page, 1);
    await page.locator('#job-size').selectOption('4');
    await page.getByRole('button', { name: 'Start a comparison' }).click();
    const button = page.getByRole('button', { name: 'Save report' });
    await button.waitFor({ timeout: 90_000 });
    assert.ok(await page.locator('#job-report').isHidden());
    const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
    const path = join(folder, 'saved.html');
    await download.saveAs(path);
    const saved = await page.context().newPage();
    await saved.goto(`file://${path}`);
    await saved.locator('.case').first().waitFor();
    assert.match(await saved.title(), /^differs/);
  } finally {
    await page.goto('about:blank'); // a server that ends refuses
    await guarded.stop();
    rmSync(folder, { recursive: true, force: true });
  }
  // The browser itself reports refusals.
  const others = faults.filter((fault) => !/status of 401/.test(fault));
  faults.length = 0;
  assert.deepEqual(others, []);
});

test('where jobs are off the page says how to turn them on', async () => {
  const plain = await startServer(paths.chamferd, root.root, 0, WEB);
  try {
    await open(COMPARED, 1, plain);
    await page.locator('#jobs-off').waitFor();
    assert.match(await page.locator('#jobs-off').textContent(), /chamferd serve ROOT --jobs DIR/);
    assert.ok(await page.locator('#job-start').isHidden());
  } finally {
    await page.goto('about:blank');
    await plain.stop();
  }
});

test('a scene that is not there is told, and A is compared with itself', async () => {
  await open(`${COMPARED}&b-scene=no/such`, 1);
  await page.locator('#problem').waitFor();
  assert.match(await page.locator('#problem').textContent(), /no\/such/);
  assert.equal(await page.locator('#scene-b').inputValue(), '');
  const others = faults.filter((fault) => !/status of 404/.test(fault));
  faults.length = 0;
  assert.deepEqual(others, []);
});

for (const [name, options] of [['desktop', DESKTOP], ['phone', PHONE], ['reduced motion', { ...PHONE, reducedMotion: 'reduce' }]]) {
  test(`${name}: every mode passes axe and nothing scrolls sideways`, async () => {
    await newPage(options);
    for (const mode of ['off', 'slider', 'beside', 'difference']) {
      await open(COMPARED.replace('slider', mode).replace('none', 'mesh:4'), 1);
      const [content, window] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
      assert.ok(content <= window, `${mode}: ${content} of ${window} pixels`);
      // Not as a script of the page, whose policy lets none in.
      await page.evaluate(AXE);
      const { violations } = await page.evaluate(() => axe.run());
      assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes[0].html, nodes[0].failureSummary]), [], mode);
    }
  });
}

test('on a phone the divider is moved by touch', async () => {
  await newPage(PHONE);
  await open(COMPARED, 1);
  const touch = await page.context().newCDPSession(page);
  const send = (type, points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  const box = await slider().boundingBox();
  const at = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  await send('touchStart', [at]);
  for (let x = at.x; x >= 90; x -= 15) await send('touchMove', [{ ...at, x }]);
  await send('touchMove', [{ ...at, x: 90 }]);
  await send('touchEnd', []);
  assert.equal(await slider().getAttribute('aria-valuenow'), '25');
  assert.ok(!(await page.evaluate(() => location.hash)).includes('camera=0,-4,0.1'));
});
