export interface LatestOptions {
  /** Receives errors; absent where another request already reports them. */
  failed?: (error: unknown) => void;
  /** A request older than this gives way to a newer one; without it, every request is let finish. */
  patienceMs?: number;
}

/**
 * Asks with the newest request only: one is under way at most, and while it is, a newer one replaces the one that waits.
 * Answers still come at the rate of the one who answers, so that what is dragged is followed and never queued.
 */
export class Latest<Request, Answer> {
  #running: AbortController | null = null;
  #started_ms = 0;
  #waiting: { request: Request } | null = null;

  constructor(
    private readonly ask: (request: Request, signal: AbortSignal) => Promise<Answer>,
    private readonly answered: (answer: Answer, request: Request) => void,
    private readonly options: LatestOptions = {},
  ) {}

  send(request: Request): void {
    if (!this.#running) {
      void this.#run(request);
      return;
    }
    this.#waiting = { request };
    const age_ms = performance.now() - this.#started_ms;
    if (age_ms > (this.options.patienceMs ?? Infinity)) this.#running.abort();
  }

  /** Forgets what waits, and gives up what is under way: its answer would be about something that is gone. */
  cancel(): void {
    this.#waiting = null;
    this.#running?.abort();
    this.#running = null;
  }

  async #run(request: Request): Promise<void> {
    const running = new AbortController();
    this.#running = running;
    this.#started_ms = performance.now();
    try {
      const answer = await this.ask(request, running.signal);
      if (!running.signal.aborted) this.answered(answer, request);
    } catch (error) {
      if (!running.signal.aborted) this.options.failed?.(error);
    }
    // Cancelled meanwhile, perhaps by who was told: another run may have begun.
    if (this.#running !== running) return;
    this.#running = null;
    const waiting = this.#waiting;
    this.#waiting = null;
    if (waiting) void this.#run(waiting.request);
  }
}
