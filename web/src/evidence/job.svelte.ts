import { onMount } from "svelte";

import { backAfter } from "../shell/loaded.svelte";

/** A computation of the program in the background: asked again while it runs. */
export class Job<View extends { state: string }> {
  problem = $state.raw<{ what: string; error: unknown } | null>(null);
  #turn = 0;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** Reads the state of a component's computation now, and until the component is gone. */
  constructor(
    title: string,
    private readonly read: () => Promise<View>,
    private readonly use: (view: View) => void,
    private readonly again_ms: number,
  ) {
    onMount(() => {
      void this.ask(`${title} could not be loaded`, this.read);
      return () => {
        this.#turn += 1;
        clearTimeout(this.#timer);
      };
    });
  }

  /** Sends a request, such as the start or the cancel. */
  async ask(what: string, question: () => Promise<View>): Promise<void> {
    clearTimeout(this.#timer);
    this.#turn += 1;
    const turn = this.#turn;
    try {
      const view = await question();
      // An answer to an older question would undo a cancel.
      if (turn !== this.#turn) return;
      this.use(view);
      this.problem = null;
      if (view.state !== "running") return;
    } catch (error) {
      if (turn !== this.#turn) return;
      this.problem = { what, error };
      // The computation runs on while the connection or the session is lost.
      void backAfter(error)?.then(() => {
        if (turn === this.#turn) void this.ask(what, this.read);
      });
      return;
    }
    const next = (): void => void this.ask("The progress is unknown", this.read);
    this.#timer = setTimeout(next, this.again_ms);
  }
}
