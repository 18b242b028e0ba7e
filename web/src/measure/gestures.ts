import type { CssPoint, FilmPoint } from "./viewport";

/** Actions of a pointer on a film. */
export interface Hand {
  pan(by: CssPoint): void;
  zoom(factor: number, at: CssPoint): void;
  grey(by: CssPoint): void;
  /** The left button or a finger is pressed to place a landmark. */
  press(at: CssPoint, touch: boolean): void;
  /** The pointer moves while pressed; `far` if it has left its start. */
  drag(at: CssPoint, far: boolean): void;
  release(at: CssPoint, far: boolean): void;
  /** The press is cancelled: by a second finger or by the browser. */
  abandon(): void;
  hover(at: CssPoint | null): void;
  /** Action of the left button. */
  leftButton(): "mark" | "pan" | "grey";
}

/** What the left button, a finger and the crosshair of the keys do on the film. */
export interface PointerMode extends Pick<Hand, "press" | "drag" | "release" | "abandon"> {
  /** Whether the loupe helps now. */
  readonly magnifies: boolean;
  /** Acts at the crosshair. */
  placeAt(at: FilmPoint): void;
}

type Doing = "nothing" | "mark" | "pan" | "grey" | "pinch";

/** A shorter move is a click. */
const STILL_CSS = 3;

/** Recognises clicks, drags, pans and pinches of mouse, pen and fingers. */
export class Gestures {
  #pointers = new Map<number, CssPoint>();
  #doing: Doing = "nothing";
  #from: CssPoint = [0, 0];
  #far = false;

  constructor(
    readonly element: HTMLElement,
    readonly hand: Hand,
  ) {}

  attach(): () => void {
    const { element } = this;
    const stop = new AbortController();
    const options = { signal: stop.signal };
    element.addEventListener("pointerdown", (event) => this.#down(event), options);
    element.addEventListener("pointermove", (event) => this.#move(event), options);
    element.addEventListener("pointerup", (event) => this.#up(event), options);
    element.addEventListener("pointercancel", (event) => this.#cancel(event), options);
    element.addEventListener("pointerleave", () => this.hand.hover(null), options);
    element.addEventListener("contextmenu", (event) => event.preventDefault(), options);
    element.addEventListener("wheel", (event) => this.#wheel(event), {
      ...options,
      passive: false,
    });
    return () => stop.abort();
  }

  #at(event: MouseEvent): CssPoint {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #down(event: PointerEvent): void {
    const at = this.#at(event);
    this.element.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, at);
    if (this.#pointers.size > 1) {
      if (this.#doing === "mark") this.hand.abandon();
      this.#doing = "pinch";
      return;
    }
    // The middle button would scroll.
    if (event.button === 1) event.preventDefault();
    const left = this.hand.leftButton();
    this.#doing = event.button === 1 ? "pan" : event.button === 2 ? "grey" : left;
    this.#from = at;
    this.#far = false;
    if (this.#doing === "mark") this.hand.press(at, event.pointerType === "touch");
  }

  #move(event: PointerEvent): void {
    const at = this.#at(event);
    const before = this.#pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") this.hand.hover(at);
      return;
    }
    if (this.#doing === "pinch") this.#pinch(event.pointerId, before, at);
    this.#pointers.set(event.pointerId, at);
    const by: CssPoint = [at[0] - before[0], at[1] - before[1]];
    if (this.#doing === "pan") this.hand.pan(by);
    if (this.#doing === "grey") this.hand.grey(by);
    this.hand.hover(at);
    if (this.#doing !== "mark") return;
    this.#far ||= Math.hypot(at[0] - this.#from[0], at[1] - this.#from[1]) > STILL_CSS;
    this.hand.drag(at, this.#far);
  }

  #up(event: PointerEvent): void {
    const at = this.#at(event);
    if (!this.#pointers.delete(event.pointerId)) return;
    if (this.#doing === "mark") this.hand.release(at, this.#far);
    // The finger that remains after a pinch places no landmark.
    if (this.#pointers.size === 0) this.#doing = "nothing";
    if (event.pointerType === "touch") this.hand.hover(null);
  }

  #cancel(event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#doing === "mark") this.hand.abandon();
    if (this.#pointers.size === 0) this.#doing = "nothing";
    this.hand.hover(null);
  }

  #pinch(moving: number, before: CssPoint, now: CssPoint): void {
    const other = [...this.#pointers].find(([id]) => id !== moving)?.[1];
    if (!other) return;
    const apart = (a: CssPoint): number => Math.hypot(a[0] - other[0], a[1] - other[1]);
    const middle = (a: CssPoint): CssPoint => [(a[0] + other[0]) / 2, (a[1] + other[1]) / 2];
    const [from, to] = [middle(before), middle(now)];
    this.hand.pan([to[0] - from[0], to[1] - from[1]]);
    if (apart(before) > 1) this.hand.zoom(apart(now) / apart(before), to);
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    // Some mice scroll by lines or pages.
    const unit = [1, 16, 400][event.deltaMode] ?? 1;
    const step = Math.max(-200, Math.min(200, event.deltaY * unit));
    // A pinch on a touchpad arrives as a wheel with the control key, in small steps.
    this.hand.zoom(Math.exp(-step * (event.ctrlKey ? 0.01 : 0.0018)), this.#at(event));
  }
}
