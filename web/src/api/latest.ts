export interface LatestOptions {
  /** Receives errors; absent where another request already reports them. */
  failed?: (error: unknown) => void;
  /** A request older than this is aborted for a newer one; without it, every request may finish. */
  patienceMs?: number;
}

/**
 * Sends the newest request only: at most one is running, and a newer one replaces the one that waits.
 * Answers keep the rate of the program, so that a drag is followed without a queue.
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

  /** Drops the waiting request and aborts the running one, because its answer is not needed. */
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
    // Cancelled in between, possibly by a callback: another run may have begun.
    if (this.#running !== running) return;
    this.#running = null;
    const waiting = this.#waiting;
    this.#waiting = null;
    if (waiting) void this.#run(waiting.request);
  }
}
