import { Unreachable, listen } from "../api/client";
import { readSignInPage } from "../api/session";
import { session } from "./session.svelte";

const MIN_WAIT_MS = 1_000;
const MAX_WAIT_MS = 10_000;

/** Whether the program answers. */
class Connection {
  /** The last request had no answer. Pages keep unsent changes. */
  lost = $state(false);
  /** A request to the program is running. */
  asking = $state(false);

  #wait_ms = MIN_WAIT_MS;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #waiting: (() => void)[] = [];

  constructor() {
    listen({
      answered: () => this.#found(),
      unreachable: () => this.#lose(),
      expired: () => session.expire(),
      changed: () => session.renew(),
    });
  }

  /** Resolves when the program answers again; at once if it does. */
  back(): Promise<void> {
    if (!this.lost) return Promise.resolve();
    return new Promise((resolve) => this.#waiting.push(resolve));
  }

  /** Sends a request now and does not wait. */
  async retry(): Promise<void> {
    clearTimeout(this.#timer);
    if (this.asking) return;
    this.asking = true;
    try {
      await readSignInPage();
    } catch (error) {
      // An error response is an answer too.
      if (error instanceof Unreachable) this.#again();
    } finally {
      this.asking = false;
    }
  }

  #lose(): void {
    if (this.lost) return;
    this.lost = true;
    this.#wait_ms = MIN_WAIT_MS;
    this.#again();
  }

  #again(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.retry(), this.#wait_ms);
    this.#wait_ms = Math.min(MAX_WAIT_MS, this.#wait_ms * 1.5);
  }

  #found(): void {
    if (!this.lost) return;
    clearTimeout(this.#timer);
    this.lost = false;
    for (const resolve of this.#waiting.splice(0)) resolve();
  }
}

export const connection = new Connection();
