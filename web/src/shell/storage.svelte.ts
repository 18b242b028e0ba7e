/** What the browser keeps, where it does: settings may forbid it, and it may be full. Nothing here throws. */
class Storage {
  /** What was to survive a reload was not kept: to be told to whoever is here. */
  refused = $state(false);

  constructor(private readonly area: () => globalThis.Storage) {}

  get(key: string): string | null {
    return this.#tried(() => this.area().getItem(key), null);
  }

  /** Says whether it is kept now. */
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

  /** Even to name it throws where it is forbidden. */
  #tried<T>(what: () => T, otherwise: T): T {
    try {
      return what();
    } catch {
      return otherwise;
    }
  }
}

/** Of this address, from one visit to the next. */
export const lasting = new Storage(() => localStorage);
/** Of this window, from reload to reload. */
export const ofWindow = new Storage(() => sessionStorage);
