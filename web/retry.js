// Trying again when the server is busy or away.

const RETRY_SECONDS = { first: 1, longest: 20 };

/**
 * Runs requests again while they fail with an error whose `passing` is true: after its `retryAfter` seconds, or else
 * after pauses that double. Any other error, and an aborted signal, ends it.
 */
export class Retry {
  /** `onWait(seconds, error)` is told of every pause. */
  constructor(onWait) {
    this.onWait = onWait;
    this.pause = RETRY_SECONDS.first;
  }

  async run(request, signal) {
    for (;;) {
      try {
        const result = await request();
        this.pause = RETRY_SECONDS.first;
        return result;
      } catch (error) {
        if (!error.passing || signal.aborted) throw error;
        const seconds = Math.min(error.retryAfter ?? this.pause, RETRY_SECONDS.longest);
        this.pause = Math.min(this.pause * 2, RETRY_SECONDS.longest);
        this.onWait(seconds, error);
        await sleep(seconds * 1000, signal);
      }
    }
  }
}

function sleep(milliseconds, signal) {
  return new Promise((resolve, reject) => {
    const stopped = () => {
      clearTimeout(timer);
      reject(new DOMException('stopped', 'AbortError'));
    };
    const timer = setTimeout(() => {
      signal.removeEventListener('abort', stopped);
      resolve();
    }, milliseconds);
    if (signal.aborted) stopped();
    else signal.addEventListener('abort', stopped, { once: true });
  });
}
