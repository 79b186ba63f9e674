// The HTML report of comparisons in a real browser, from a file, without a network:
//   node tests/browser/report.test.mjs --sample PATH     (the built program report_sample)
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { openBrowser, watchConsole } from './browser.mjs';

const { values: paths } = parseArgs({ options: { sample: { type: 'string' } } });
if (!paths.sample) throw new Error('--sample is missing');

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const DESKTOP = { viewport: { width: 1280, height: 900 } };
const PHONE = { viewport: { width: 360, height: 740 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };

let folder;
let browser;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'chamfer-report-'));
  for (const which of ['all', 'one', 'hostile', 'none']) execFileSync(paths.sample, [join(folder, `${which}.html`), which]);
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Opens a report with the network off, hands the page to `look`, and holds that nothing else was asked for and nothing went wrong. */
async function withReport(which, options, look) {
  const context = await browser.newContext({ ...options, offline: true });
  const page = await context.newPage();
  const faults = watchConsole(page);
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  const url = pathToFileURL(join(folder, `${which}.html`)).href;
  await page.goto(url);
  await look(page);
  assert.deepEqual(asked.filter((address) => address !== url && !address.startsWith('data:')), []);
  assert.deepEqual(faults, []);
  await context.close();
}

const widths = (page) => page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);

async function openAll(page) {
  await page.evaluate(() => { for (const one of document.querySelectorAll('details')) one.open = true; });
  await page.waitForFunction(() => document.querySelectorAll('.body').length === document.querySelectorAll('details').length);
  await page.waitForFunction(() => [...document.images].every((image) => image.complete && image.naturalWidth > 0));
}

/** The colour that is seen at shares of an element's width and height. */
async function colorAt(page, locator, u, v) {
  const png = (await locator.screenshot()).toString('base64');
  return page.evaluate(async ([data, x, y]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    return [...context.getImageData(Math.floor(x * image.width), Math.floor(y * image.height), 1, 1).data].slice(0, 3);
  }, [png, u, v]);
}
const apart = (p, q) => Math.max(...p.map((value, i) => Math.abs(value - q[i])));

for (const [name, options] of [['desktop', DESKTOP], ['phone', PHONE], ['dark', { ...DESKTOP, colorScheme: 'dark' }]]) {
  test(`${name}: every case is shown, accessible, and nothing scrolls sideways`, async () => {
    for (const which of ['all', 'one', 'hostile', 'none']) {
      await withReport(which, options, async (page) => {
        await openAll(page);
        const [content, window] = await widths(page);
        assert.ok(content <= window, `${which}: ${content} of ${window} pixels`);
        await page.evaluate(AXE);
        const { violations } = await page.evaluate(() => axe.run());
        assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes[0].html, nodes[0].failureSummary]), [], which);
        // The same pictures beside each other and enlarged.
        for (const beside of await page.locator('input[value="beside"]').all()) await beside.check({ force: true });
        for (const zoom of await page.locator('select').all()) await zoom.selectOption('4');
        const [wide, seen] = await widths(page);
        assert.ok(wide <= seen, `${which}, beside: ${wide} of ${seen} pixels`);
        const besideRun = await page.evaluate(() => axe.run());
        assert.deepEqual(besideRun.violations.map(({ id, nodes }) => [id, nodes[0].html]), [], `${which}, beside`);
      });
    }
  });
}

test('the slider is moved by keyboard, mouse and touch, and shows A left of it and B right of it', async () => {
  await withReport('one', { ...DESKTOP, hasTouch: true }, async (page) => {
    await page.locator('label', { hasText: 'Marks' }).click();
    const wipe = page.getByRole('slider', { name: 'Divider between A and B' });
    const frame = page.locator('.frame').first();
    // Within the square, where A is brighter by a quarter of what can be shown.
    const [u, v] = [0.66, 0.31];
    await wipe.focus();
    await page.keyboard.press('End');
    const a = await colorAt(page, frame, u, v);
    await page.keyboard.press('Home');
    const b = await colorAt(page, frame, u, v);
    assert.ok(apart(a, b) > 30, `${a} and ${b}`);

    const box = await frame.boundingBox();
    const at = (share) => [box.x + share * box.width, box.y + 0.6 * box.height];
    await page.mouse.move(...at(0.2));
    await page.mouse.down();
    await page.mouse.move(...at(0.9), { steps: 5 });
    await page.mouse.up();
    assert.ok(Math.abs(Number(await wipe.inputValue()) - 90) < 2, await wipe.inputValue());
    assert.ok(apart(await colorAt(page, frame, u, v), a) < 3);
    await page.touchscreen.tap(...at(0.25));
    assert.ok(Math.abs(Number(await wipe.inputValue()) - 25) < 2, await wipe.inputValue());
    assert.ok(apart(await colorAt(page, frame, u, v), b) < 3);
    const divider = await page.locator('.divider').boundingBox();
    assert.ok(Math.abs(divider.x + divider.width / 2 - at(0.25)[0]) < 6);
    await wipe.focus();
    await page.keyboard.press('ArrowRight');
    assert.ok(Number(await wipe.inputValue()) > 25 && Number(await wipe.inputValue()) < 30);
  });
});

test('the marks are where the result says, in a crop, too', async () => {
  await withReport('all', DESKTOP, async (page) => {
    const { result } = JSON.parse(await page.locator('#data').textContent());
    let count = 0;
    for (const [i, { largest, region }] of result.cases.entries()) {
      const one = page.locator(`#case-${i + 1}`);
      if (!largest || largest.error === 0 || !(await one.evaluate((element) => element.open))) continue;
      for (const frame of await one.locator('.viewport').all()) {
        const [mark, whole] = [await frame.locator('.mark.ring').boundingBox(), await frame.boundingBox()];
        const wanted = (largest.x - region.crop.x + 0.5) / region.crop.width;
        assert.ok(Math.abs((mark.x + mark.width / 2 - whole.x) / whole.width - wanted) < 0.005, `case ${i + 1}`);
        count += 1;
      }
    }
    assert.ok(count >= 6, `${count} marks`);
  });
});

test('a place is shown enlarged in all pictures, which scroll together', async () => {
  await withReport('one', DESKTOP, async (page) => {
    await page.getByRole('button', { name: /^Show: largest/ }).click();
    assert.equal(await page.getByLabel('Zoom').inputValue(), '8');
    const views = page.locator('.viewport');
    for (const view of await views.all()) {
      const [mark, seen] = [await view.locator('.mark.ring').boundingBox(), await view.boundingBox()];
      assert.ok(Math.abs(mark.x + mark.width / 2 - (seen.x + seen.width / 2)) < 20);
      assert.ok(Math.abs(mark.y + mark.height / 2 - (seen.y + seen.height / 2)) < 20);
      assert.equal(await view.locator('img').first().evaluate((image) => getComputedStyle(image).imageRendering), 'pixelated');
    }
    await views.nth(1).evaluate((view) => view.scrollTo(100, 60));
    await page.waitForFunction(() => document.querySelector('.viewport').scrollLeft === 100 && document.querySelector('.viewport').scrollTop === 60);
  });
});

test('the filter leaves what is not the same', async () => {
  await withReport('all', DESKTOP, async (page) => {
    const cases = page.locator('.case');
    assert.equal(await cases.count(), 9);
    await page.getByLabel(/^Not same/).check({ force: true });
    const seen = await cases.evaluateAll((all) => all.filter((one) => one.offsetParent).map((one) => one.dataset.outcome));
    assert.equal(seen.length, 7);
    assert.ok(!seen.includes('same'));
    await page.getByLabel(/^All/).check({ force: true });
    assert.equal(await cases.evaluateAll((all) => all.filter((one) => one.offsetParent).length), 9);
  });
});

test('metrics say in words whether they are within their limits, and numbers that are none are named', async () => {
  await withReport('all', DESKTOP, async (page) => {
    await openAll(page);
    const rows = (i) => page.locator(`#case-${i} .metrics tbody tr`).allTextContents();
    assert.match((await rows(1)).join('|'), /mae0\.0213 ± 0\.0004≤ 0\.005✗ beyond\|psnr31\.72 ± 0\.05 dB≥ 30 dB✓ within\|bias.*cannot tell.*no limit/);
    assert.match((await rows(3)).join('|'), /psnr∞ dB/);
    assert.match((await rows(6)).join('|'), /not a number.*−∞ %/);
    assert.match(await page.locator('#case-2').textContent(), /Any difference above 0\.3 % of an 8 x 8 block would have been seen/);
    assert.match(await page.locator('#case-4').textContent(), /B is stale.*left out \(region\)/);
    assert.match(await page.locator('#case-9').textContent(), /each pixel is the mean of 2 × 2 pixels/);
  });
});

test('the command is copied', async () => {
  await withReport('one', DESKTOP, async (page) => {
    await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
    await page.getByRole('button', { name: 'Copy' }).click();
    await page.getByRole('button', { name: 'Copied' }).waitFor();
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), await page.locator('pre code').textContent());
  });
});

test('nothing in a result becomes part of the page', async () => {
  await withReport('hostile', DESKTOP, async (page) => {
    await openAll(page);
    assert.equal(await page.locator('script').count(), 3);
    assert.equal(await page.locator('img[src=x]').count(), 0);
    assert.match(await page.title(), /^error|^differs/);
    const name = await page.locator('#case-1 h2').textContent();
    assert.ok(name.includes('</script><!-- "\'&]]>') && name.includes('@DATA@'), name);
  });
});

test('without JavaScript the report is a text, on paper it has no controls', async () => {
  await withReport('all', { ...DESKTOP, javaScriptEnabled: false }, async (page) => {
    assert.match(await page.locator('noscript').textContent(), /verdict +differs: mae is 0\.0213/);
  });
  await withReport('all', DESKTOP, async (page) => {
    await page.emulateMedia({ media: 'print' });
    for (const button of await page.locator('button, .wipe').all()) assert.ok(!(await button.isVisible()));
    assert.ok(await page.locator('#case-1 .metrics').isVisible());
  });
});
