import { ask } from "../api/client";
import type { Api } from "../api/types";

/** What the finished readings of a study say of one film: shown while nobody marks it. */
export class Finished {
  live = $state.raw<Api<"LiveView"> | null>(null);

  async load(study: string, film: number, signal: AbortSignal): Promise<void> {
    this.live = null;
    const path = `/api/studies/${encodeURIComponent(study)}`;
    const [findings, overlay] = await Promise.all([
      ask<Api<"LiveView">>("GET", `${path}/findings`, { signal }),
      // A film without a finished reading has none.
      ask<Api<"FilmOverlay">>("GET", `${path}/films/${film}/overlay`, { signal }).catch(() => null),
    ]);
    if (!signal.aborted) this.live = { ...findings, overlay };
  }
}
