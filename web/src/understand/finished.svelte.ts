import { readFindings, readHeights, readOverlay } from "../api/studies";
import type { Api } from "../api/types";

/** Results of a study's finished readings for one film, shown without an open reading. */
export class Finished {
  live = $state.raw<Api<"LiveView"> | null>(null);

  /** Loads the results; without any the film is shown alone. Returns a function that stops the requests. */
  show(study: string, film: number): () => void {
    const stop = new AbortController();
    this.#load(study, film, stop.signal).catch(() => (this.live = null));
    return () => stop.abort();
  }

  async #load(study: string, film: number, signal: AbortSignal): Promise<void> {
    this.live = null;
    const [findings, overlay, heights] = await Promise.all([
      readFindings(study, signal),
      // A film without a finished reading has none.
      readOverlay(study, film, signal).catch(() => null),
      readHeights(study, film, signal).catch(() => []),
    ]);
    if (!signal.aborted) this.live = { ...findings, overlay, heights };
  }
}
