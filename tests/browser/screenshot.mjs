// Saves a screenshot of the page, for looking at it: node tests/browser/screenshot.mjs URL OUT.png [--size 1280x800]
// [--wait-samples 32] [--phone]. The server must be running. Console errors of the page are printed.
import { parseArgs } from 'node:util';

import { openBrowser, watchConsole } from './browser.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    size: { type: 'string', default: '1280x800' },
    'wait-samples': { type: 'string', default: '32' },
    phone: { type: 'boolean', default: false },
  },
});
const [url, output] = positionals;
if (!url || !output) {
  console.error('usage: screenshot.mjs URL OUT.png [--size WxH] [--wait-samples N] [--phone]');
  process.exit(2);
}

const [width, height] = (values.phone ? '390x844' : values.size).split('x').map(Number);
const browser = await openBrowser();
try {
  const page = await browser.newPage({
    viewport: { width, height },
    deviceScaleFactor: values.phone ? 3 : 1,
    hasTouch: values.phone,
    isMobile: values.phone,
  });
  const faults = watchConsole(page);
  await page.goto(url);
  const samples = Number(values['wait-samples']);
  await page.waitForFunction(
    (wanted) => Number(document.getElementById('status').textContent.match(/(\d+) of/)?.[1]) >= wanted,
    samples,
    { timeout: 120_000 },
  );
  await page.screenshot({ path: output });
  console.log(await page.locator('#status').textContent());
  for (const fault of faults) console.error(fault);
} finally {
  await browser.close();
}
