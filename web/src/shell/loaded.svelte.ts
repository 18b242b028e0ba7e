import { Refusal, Unreachable } from "../api/client";
import { connection } from "./connection.svelte";
import { session } from "./session.svelte";

/** Something that a page reads from the program, and reads again when the program or the person is back. */
export class Loaded<T> {
  value = $state.raw<T | null>(null);
  /** Why it could not be read; what was read before stays. */
  error = $state.raw<unknown>(null);

  constructor(private readonly read: () => Promise<T>) {}

  load = async (): Promise<void> => {
    try {
      this.value = await this.read();
      this.error = null;
    } catch (caught) {
      const back = backAfter(caught);
      if (!back) this.error = caught;
      else void back.then(this.load);
    }
  };
}

/** What has to come back before it is worth asking again; null where asking again is the person's. */
function backAfter(error: unknown): Promise<void> | null {
  if (error instanceof Unreachable) return connection.back();
  if (error instanceof Refusal && error.status === 401) return session.back();
  return null;
}
