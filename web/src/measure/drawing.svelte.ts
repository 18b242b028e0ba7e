import { Latest } from "../api/latest";
import { measureDrawn } from "../api/studies";
import type { Api } from "../api/types";
import type { PointerMode } from "./gestures";
import type { Viewer } from "./viewer.svelte";
import { cssOf, filmOf, type CssPoint, type FilmPoint } from "./viewport";

/** Distance within which a press grabs an end of a line. */
const REACH_CSS = { mouse: 8, touch: 20 };

/** Clicks that a measurement needs. */
const ENDS = { length: 2, angle: 4 } as const;
/** Answers that take longer are not awaited during a drag. */
const PATIENCE_MS = 250;

export type DrawnKind = keyof typeof ENDS;

const NEXT: Record<DrawnKind, readonly string[]> = {
  length: ["Click one end, or drag from end to end.", "Click the other end."],
  angle: [
    "Click one end of the first line, or drag it.",
    "Click the other end of the first line.",
    "Click one end of the second line, or drag it.",
    "Click the other end of the second line.",
  ],
};

/** A length or an angle that is drawn on a film and not stored. The program measures it. */
export class Drawing implements PointerMode {
  /** Ends of the lines, two by two. */
  ends = $state.raw<readonly FilmPoint[]>([]);
  answer = $state.raw<Api<"DrawnView"> | null>(null);
  error = $state.raw<unknown>(null);
  #isDown = $state(false);
  /** The end under the pointer. */
  #held: number | null = null;
  #from: CssPoint = [0, 0];
  #asked: Latest<Api<"DrawnRequest">, Api<"DrawnView">>;

  constructor(
    readonly viewer: Viewer,
    film: number,
    readonly kind: DrawnKind,
  ) {
    this.#asked = new Latest(
      (request, signal) => measureDrawn(film, request, signal),
      (answer) => {
        this.answer = answer;
        this.error = null;
      },
      {
        failed: (error) => {
          this.answer = null;
          this.error = error;
        },
        patienceMs: PATIENCE_MS,
      },
    );
  }

  get name(): string {
    return this.kind === "length" ? "Length" : "Angle";
  }

  get isComplete(): boolean {
    return this.ends.length === ENDS[this.kind];
  }

  get magnifies(): boolean {
    return this.#isDown || (this.viewer.loupe && !this.isComplete);
  }

  /** The next step; null for a complete measurement. */
  get next(): string | null {
    return NEXT[this.kind][this.ends.length] ?? null;
  }

  press(at: CssPoint, touch: boolean): void {
    const reach = REACH_CSS[touch ? "touch" : "mouse"];
    const far = this.ends.map((end) => {
      const [x, y] = cssOf(this.viewer.view, end);
      return Math.hypot(x - at[0], y - at[1]);
    });
    const nearest = far.indexOf(Math.min(...far));
    this.#held = nearest >= 0 && far[nearest]! <= reach ? nearest : null;
    this.#from = at;
    this.#isDown = true;
    this.viewer.crosshair = null;
  }

  drag(at: CssPoint, far: boolean): void {
    if (!far) return;
    if (this.#held === null) {
      // A press that moves draws a line from its start, or from the end that was clicked before.
      if (this.isComplete || this.ends.length % 2 === 0) this.placeAt(this.#film(this.#from));
      this.placeAt(this.#film(at));
      this.#held = this.ends.length - 1;
      return;
    }
    this.ends = this.ends.map((end, index) => (index === this.#held ? this.#film(at) : end));
    this.#measure();
  }

  release(at: CssPoint, far: boolean): void {
    this.#isDown = false;
    const end = this.#held === null ? undefined : this.ends[this.#held];
    if (!far && !end) this.placeAt(this.#film(at));
    // The second line may begin at an end of the first one.
    else if (!far && end && this.ends.length === 2 && !this.isComplete) this.placeAt(end);
    this.#held = null;
  }

  abandon(): void {
    this.#isDown = false;
    this.#held = null;
  }

  /** Places the next end; a complete measurement begins anew. */
  placeAt(at: FilmPoint): void {
    this.ends = this.isComplete ? [at] : [...this.ends, at];
    this.#measure();
  }

  clear(): void {
    this.ends = [];
    this.#measure();
  }

  #measure(): void {
    const [a, b, c, d] = this.ends.map((end) => [...end]);
    this.error = null;
    if (!this.isComplete) {
      this.#asked.cancel();
      this.answer = null;
    } else if (this.kind === "length") {
      this.#asked.send({ kind: "length", from_px: a!, to_px: b! });
    } else {
      this.#asked.send({
        kind: "angle",
        first_from_px: a!,
        first_to_px: b!,
        second_from_px: c!,
        second_to_px: d!,
      });
    }
  }

  /** The place on the film, or the nearest one beside it. */
  #film(at: CssPoint): FilmPoint {
    const { columns, rows } = this.viewer.film;
    const [column, row] = filmOf(this.viewer.view, at);
    const within = (value: number, count: number): number =>
      Math.min(count - 0.501, Math.max(-0.5, value));
    return [within(column, columns), within(row, rows)];
  }
}
