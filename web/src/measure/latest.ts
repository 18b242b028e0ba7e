/** One request at a time; of those that come meanwhile only the newest is kept. */
export class LatestOnly<Request, Answer> {
  #running: AbortController | null = null;
  #started = 0;
  #waiting: { request: Request } | null = null;

  constructor(
    readonly ask: (request: Request, signal: AbortSignal) => Promise<Answer>,
    readonly answered: (answer: Answer, request: Request) => void,
    /** A request older than this gives way to a newer one; a younger one is let finish, or a fast hand would see nothing. */
    readonly patienceMs = 250,
  ) {}

  want(request: Request): void {
    if (!this.#running) {
      void this.#run(request);
      return;
    }
    this.#waiting = { request };
    if (performance.now() - this.#started > this.patienceMs) this.#running.abort();
  }

  /** Nothing that was asked is wanted any more. */
  cancel(): void {
    this.#waiting = null;
    this.#running?.abort();
    this.#running = null;
  }

  async #run(request: Request): Promise<void> {
    const running = new AbortController();
    this.#running = running;
    this.#started = performance.now();
    try {
      const answer = await this.ask(request, running.signal);
      if (!running.signal.aborted) this.answered(answer, request);
    } catch {
      // An answer while dragging is a courtesy: the drop is recorded, and errors are told there.
    }
    if (this.#running !== running) return;
    this.#running = null;
    const waiting = this.#waiting;
    this.#waiting = null;
    if (waiting) void this.#run(waiting.request);
  }
}
