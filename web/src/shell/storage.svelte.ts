/** Storage of the browser. It may be disabled or full; no method throws. */
class Storage {
  /** A write failed: the person must be told that a reload loses changes. */
  refused = $state(false);

  constructor(private readonly area: () => globalThis.Storage) {}

  get(key: string): string | null {
    return this.#tried(() => this.area().getItem(key), null);
  }

  /** Returns whether the text was stored. */
  set(key: string, text: string): boolean {
    return this.#tried(() => {
      this.area().setItem(key, text);
      return true;
    }, false);
  }

  remove(key: string): void {
    this.#tried(() => this.area().removeItem(key), undefined);
  }

  keys(): string[] {
    return this.#tried(() => Object.keys(this.area()), []);
  }

  /** Access itself throws where storage is disabled. */
  #tried<T>(what: () => T, otherwise: T): T {
    try {
      return what();
    } catch {
      return otherwise;
    }
  }
}

/** Kept for this address between visits. */
export const lasting = new Storage(() => localStorage);
/** Kept for this window across reloads. */
export const ofWindow = new Storage(() => sessionStorage);
