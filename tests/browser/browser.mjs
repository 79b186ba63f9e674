// Debian's Chromium, driven by Playwright.
import { existsSync } from 'node:fs';

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';

/** Starts a headless browser with a profile of its own. Throws an error that names the fix when something is missing. */
export async function openBrowser() {
  if (!existsSync(CHROMIUM)) {
    throw new Error(`${CHROMIUM} is missing; install it (apt-get install chromium) or set CHROMIUM to a Chromium binary`);
  }
  const { chromium } = await import('playwright-core').catch((cause) => {
    throw new Error('playwright-core is missing; run: npm ci --prefix tests/browser', { cause });
  });
  return chromium.launch({
    executablePath: CHROMIUM,
    headless: true,
    args: [
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
}

/** List that fills with what the page reports as errors: exceptions, console errors, failed requests. */
export function watchConsole(page) {
  const faults = [];
  page.on('pageerror', (error) => faults.push(`exception: ${error.stack ?? error.message}`));
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) faults.push(`console ${message.type()}: ${message.text()}`);
  });
  page.on('requestfailed', (request) => {
    // Aborting outdated tiles is the page's habit, not a fault.
    const reason = request.failure()?.errorText;
    if (reason !== 'net::ERR_ABORTED') faults.push(`request failed: ${request.url()} ${reason}`);
  });
  return faults;
}
