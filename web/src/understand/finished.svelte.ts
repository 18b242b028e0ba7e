import { readFindings, readOverlay } from "../api/studies";
import type { Api } from "../api/types";

/** What the finished readings of a study say of one film: shown while nobody marks it. */
export class Finished {
  live = $state.raw<Api<"LiveView"> | null>(null);

  async load(study: string, film: number, signal: AbortSignal): Promise<void> {
    this.live = null;
    const [findings, overlay] = await Promise.all([
      readFindings(study, signal),
      // A film without a finished reading has none.
      readOverlay(study, film, signal).catch(() => null),
    ]);
    if (!signal.aborted) this.live = { ...findings, overlay };
  }
}
