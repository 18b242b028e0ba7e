import { loadModel } from "../api/studies";
import { Latest } from "../api/latest";
import type { Api } from "../api/types";
import { at, type Point } from "./shapes";

/** Name of the browser's time measurements of a drag, from pointer event to picture. */
export const POINTER_TO_RESULT = "load: pointer to result";

interface Asked {
  request: Api<"LoadRequest">;
  since_ms: number;
}

/** A load on one vertebra and the response to it. */
export class HandLoad {
  level = $state("T7");
  tip = $state.raw<Point>([0, 0, 0]);
  answer = $state.raw<Api<"LoadAnswer"> | null>(null);
  problem = $state.raw<unknown>(null);
  /** Text for screen readers: the newest state, updated at intervals. */
  spoken = $state("");

  #since_ms: number | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #latest: Latest<Asked, Api<"LoadAnswer">>;

  constructor(
    private readonly view: Api<"ModelView">,
    private readonly kind: () => Api<"LineKindName">,
  ) {
    this.#latest = new Latest(
      ({ request }, signal) => loadModel(view.study, request, signal),
      (answer, asked) => {
        this.answer = answer;
        this.problem = null;
        this.#since_ms = asked.since_ms;
        this.#speak();
      },
      {
        failed: (error) => {
          // The shape of an earlier load must not be shown with this load's arrow.
          this.answer = null;
          this.problem = error;
        },
      },
    );
    if (!view.bodies.some((body) => body.level === this.level)) {
      this.level = at(view.bodies, view.bodies.length - 1).level;
    }
    this.tip = this.from;
  }

  get index(): number {
    return this.view.bodies.findIndex((body) => body.level === this.level);
  }

  /** Point of action in the unloaded spine. */
  get from(): Point {
    return at(this.view.erect.midpoints_mm, this.index) as Point;
  }

  /** The load along the patient's axes, in the unit of the model: the arrow is drawn with 1 mm for 1 of it. */
  get force(): Point {
    return this.tip.map((value, axis) => value - at(this.from, axis)) as Point;
  }

  get isZero(): boolean {
    return this.force.every((value) => Math.abs(value) < 1e-9);
  }

  drag(tip: Point, since_ms = performance.now()): void {
    this.tip = tip;
    this.#ask(since_ms);
  }

  set(axis: 0 | 1 | 2, force: number): void {
    const tip: Point = [...this.tip];
    tip[axis] = at(this.from, axis) + force;
    this.drag(tip);
  }

  moveTo(level: string): void {
    const force = this.force;
    this.level = level;
    this.tip = this.from.map((value, axis) => value + at(force, axis)) as Point;
    this.again();
  }

  /** Applies the same load again, because the line and its springs have changed. */
  again(): void {
    this.#latest.cancel();
    this.answer = null;
    if (!this.isZero) this.#ask(performance.now());
  }

  reset(): void {
    this.#latest.cancel();
    this.tip = this.from;
    this.answer = null;
    this.problem = null;
    this.spoken = "No load.";
  }

  leave(): void {
    this.#latest.cancel();
    clearTimeout(this.#timer);
  }

  /** To be called when a picture is drawn; it is visible at the next frame. */
  drawn(): void {
    const start = this.#since_ms;
    if (start === null) return;
    this.#since_ms = null;
    requestAnimationFrame((end) => {
      if (end > start) performance.measure(POINTER_TO_RESULT, { start, end });
    });
  }

  #ask(since_ms: number): void {
    this.problem = null;
    const request = { kind: this.kind(), level: this.level, tip_mm: [...this.tip] as Point };
    this.#latest.send({ request, since_ms });
  }

  #speak(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      const answer = this.answer;
      if (answer) this.spoken = [answer.load_text, answer.status_text, ...answer.texts].join("; ");
    }, 700);
  }
}
