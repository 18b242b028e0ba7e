/**
 * Asks with the newest request only: one is under way at most, and while it is, a newer one replaces the one that waits.
 * Answers still come at the rate of the one who answers, so that what is dragged is followed and never queued.
 */
export class Latest<Request, Answer> {
  #waiting: { request: Request } | null = null;
  #running: AbortController | null = null;

  constructor(
    private readonly ask: (request: Request, signal: AbortSignal) => Promise<Answer>,
    private readonly answered: (answer: Answer, request: Request) => void,
    private readonly failed: (error: unknown) => void,
  ) {}

  send(request: Request): void {
    this.#waiting = { request };
    if (!this.#running) void this.#run();
  }

  /** Forgets what waits, and gives up what is under way: its answer would be about something that is gone. */
  cancel(): void {
    this.#waiting = null;
    this.#running?.abort();
    this.#running = null;
  }

  async #run(): Promise<void> {
    while (this.#waiting) {
      const { request } = this.#waiting;
      this.#waiting = null;
      const running = new AbortController();
      this.#running = running;
      try {
        const answer = await this.ask(request, running.signal);
        if (running.signal.aborted) return;
        this.answered(answer, request);
      } catch (error) {
        if (running.signal.aborted) return;
        this.failed(error);
      }
      // Cancelled by who was told of the answer: another run may have begun.
      if (this.#running !== running) return;
      this.#running = null;
    }
  }
}
