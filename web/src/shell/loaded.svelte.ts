import { onMount } from "svelte";

import { Refusal, Unreachable } from "../api/client";
import { connection } from "./connection.svelte";
import { session } from "./session.svelte";

/** Data of a component, loaded from the program and loaded again when the connection or the session is back. */
export class Loaded<T> {
  value = $state.raw<T | null>(null);
  /** Why loading failed; the previous data stay. */
  error = $state.raw<unknown>(null);

  readonly #gone = new AbortController();
  #loads = 0;

  /** Loads the data when the component starts. When the component goes, the signal aborts the request. */
  constructor(private readonly read: (signal: AbortSignal) => Promise<T>) {
    onMount(() => {
      void this.load();
      return () => this.#gone.abort();
    });
  }

  load = async (): Promise<void> => {
    const { signal } = this.#gone;
    if (signal.aborted) return;
    this.#loads += 1;
    const load = this.#loads;
    // A slow answer does not replace the answer to a newer request.
    const isOver = (): boolean => signal.aborted || load !== this.#loads;
    try {
      const value = await this.read(signal);
      if (isOver()) return;
      this.value = value;
      this.error = null;
    } catch (caught) {
      if (isOver()) return;
      const back = backAfter(caught);
      if (!back) this.error = caught;
      else void back.then(this.load);
    }
  };
}

/** What must be back before the next attempt; null if the person decides. */
export function backAfter(error: unknown): Promise<void> | null {
  if (error instanceof Unreachable) return connection.back();
  if (error instanceof Refusal && error.status === 401) return session.back();
  return null;
}
