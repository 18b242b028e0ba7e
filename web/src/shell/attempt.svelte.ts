/** An action and how it ended. */
export class Attempt {
  busy = $state(false);
  error = $state.raw<unknown>(null);

  /** Returns whether the work was done. */
  async run(work: () => Promise<unknown>): Promise<boolean> {
    this.busy = true;
    this.error = null;
    try {
      await work();
      return true;
    } catch (caught) {
      this.error = caught;
      return false;
    } finally {
      this.busy = false;
    }
  }
}
