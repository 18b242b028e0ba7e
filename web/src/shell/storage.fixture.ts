/** Storage of a browser in memory, for tests: the keys are its own properties, as in a browser. */
export const memoryStorage = (): Pick<Storage, "getItem" | "setItem" | "removeItem"> =>
  Object.create({
    getItem(this: Record<string, string>, key: string): string | null {
      return this[key] ?? null;
    },
    setItem(this: Record<string, string>, key: string, text: string): void {
      this[key] = text;
    },
    removeItem(this: Record<string, string>, key: string): void {
      delete this[key];
    },
  });
