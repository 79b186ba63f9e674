// The part of the panel that asks the server whether what is compared is the same.
import { fetchInfo, fetchReport, reportUrl } from './api.js';
import { hasEnded, Job, suiteOf } from './job.js';
import { hasKey } from './key.js';
import { save } from './panel.js';
import { jobText } from './words.js';

const byId = (id) => document.getElementById(id);
const SHARES = [1, 2, 4]; // of the picture's sides

export class JobPanel {
  /** `seen()`: what is compared now, {sides, frame} as suiteOf() takes them. `onFault(error)`: asks for a key where one is wanted. */
  constructor(seen, onFault) {
    this.seen = seen;
    this.job = new Job({
      onNews: (news) => this.#show(news),
      onFault: (error) => {
        if (error?.needsKey) onFault(error);
        this.#showFault(error);
      },
    });
    byId('job-start').addEventListener('click', () => {
      byId('job-start').disabled = true;
      const { sides, frame } = this.seen();
      this.job.start(suiteOf(sides, this.#sized(frame))).finally(() => (byId('job-start').disabled = false));
    });
    byId('job-cancel').addEventListener('click', () => this.job.cancel());
    byId('job-save').addEventListener('click', () => this.#saveReport());
  }

  /** Called whenever the comparison is shown. */
  async show({ width, height }) {
    const texts = SHARES.map((share) => `${Math.round(width / share)} x ${Math.round(height / share)}`);
    const list = texts.map((text, i) => `${text}${i === 0 ? ', as seen' : ''}`);
    const select = byId('job-size');
    if ([...select.options].map(({ text }) => text).join() !== list.join()) {
      const chosen = Math.max(0, select.selectedIndex);
      select.replaceChildren(...list.map((text, i) => new Option(text, SHARES[i])));
      select.selectedIndex = chosen;
    }
    if (this.isAsked) return;
    this.isAsked = true;
    try {
      const { comparisons } = await fetchInfo();
      byId('jobs').hidden = !comparisons;
      byId('jobs-off').hidden = Boolean(comparisons);
    } catch {
      this.isAsked = false; // at the next change again
    }
  }

  #sized({ width, height }) {
    const share = Number(byId('job-size').value);
    return { width: Math.max(1, Math.round(width / share)), height: Math.max(1, Math.round(height / share)) };
  }

  #show(news) {
    const [one] = news.cases;
    byId('job').hidden = false;
    byId('job-name').textContent = one?.name ?? '';
    byId('job-state').textContent = jobText(news);
    byId('job-state').dataset.outcome = news.outcome ?? news.state;
    byId('job-reason').textContent = one?.reason ?? news.detail ?? '';
    const bar = byId('job-progress');
    bar.hidden = hasEnded(news);
    if (news.progress?.most_seeds > 0) Object.assign(bar, { max: news.progress.most_seeds, value: news.progress.seeds });
    else bar.removeAttribute('value');
    byId('job-cancel').hidden = hasEnded(news);
    // A link cannot carry a key; what is saved opens without one.
    const hasReport = Boolean(news.links.report);
    byId('job-report').hidden = !hasReport || hasKey();
    byId('job-report').href = reportUrl(news.id);
    byId('job-save').hidden = !hasReport || !hasKey();
  }

  async #saveReport() {
    try {
      const html = await fetchReport(this.job.id);
      save(new Blob([html], { type: 'text/html' }), `comparison-${this.job.id.slice(0, 8)}.html`);
    } catch (error) {
      this.#showFault(error);
    }
  }

  #showFault(error) {
    byId('job-fault').hidden = !error;
    byId('job-fault').textContent = error?.message ?? '';
  }
}
