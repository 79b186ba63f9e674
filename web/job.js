// A comparison job: the suite of one case that asks whether what is seen is the same, and following it until it has ended.
import { cancelJob, fetchJob, startJob } from './api.js';
import { Retry } from './retry.js';
import { roundingText } from './rounding.js';
import { settingsText } from './viewstate.js';

const POLL_MS = 700;
const PLAIN = /^[A-Za-z0-9_][A-Za-z0-9_./ -]*$/;

/** A side as data/COMPARISONS.md writes it. Other names, and meshes that stand otherwise than the server has them, go by id. */
function sideText({ scene, view }) {
  const isNamed = scene.id === scene.listedId && PLAIN.test(scene.name);
  return `${isNamed ? scene.name : scene.id}?${settingsText(view)}`;
}

/**
 * `sides`: A and B, each {scene, view}: as fetchUpright() gives it, and as it is rendered. `frame`: {width, height}.
 * Equal settings have equal suites, and so one job.
 */
export function suiteOf(sides, frame) {
  const [a, b] = sides;
  const words = sides.map(({ view }) => roundingText(view.rounding) + (view.radius === null || view.rounding === 'none' ? '' : `, radius ${Number(view.radius.toPrecision(3))}`));
  const names = a.scene.name === b.scene.name ? words : words.map((text, i) => `${sides[i].scene.name} (${text})`);
  const name = (a.scene.name === b.scene.name ? `${a.scene.name}: ` : '') + names.join(' against ');
  return { schema: 'chamfer.cases/1', cases: [{ name, a: sideText(a), b: sideText(b), ...frame }] };
}

export const hasEnded = ({ state }) => !['queued', 'running'].includes(state);

/** One job at a time. */
export class Job {
  /** `onNews(job)` gets the server's state of it, `onFault(error)` what went wrong: null when it is over. */
  constructor({ onNews, onFault }) {
    this.onNews = onNews;
    this.onFault = onFault;
    this.watch = new AbortController();
    this.id = null;
  }

  async start(suite) {
    this.watch.abort();
    const { signal } = (this.watch = new AbortController());
    this.onFault(null);
    await this.#guarded(signal, async () => {
      let job = await startJob(suite, signal);
      this.id = job.id;
      const retry = new Retry((seconds, error) => this.onFault(error));
      for (;;) {
        if (signal.aborted) return;
        this.onNews(job);
        if (hasEnded(job)) return;
        await new Promise((resolve) => setTimeout(resolve, POLL_MS));
        if (signal.aborted) return;
        job = await retry.run(() => fetchJob(this.id, signal), signal);
        this.onFault(null);
      }
    });
  }

  /** Its end is seen by who watches it. */
  async cancel() {
    const { signal } = this.watch;
    await this.#guarded(signal, () => cancelJob(this.id, signal));
  }

  async #guarded(signal, work) {
    try {
      await work();
    } catch (error) {
      if (error.name !== 'AbortError' && !signal.aborted) this.onFault(error);
    }
  }
}
