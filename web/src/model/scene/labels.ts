import { Vector3, type Camera } from "three";

import type { Point } from "../shapes";

/** A label at a place of the picture. */
export interface Label {
  text: string;
  at: Point;
  /** Class of the layer's style. */
  kind: "level" | "axis" | "force" | "load";
  /** Offset on the screen in CSS pixels. */
  shift?: [number, number];
  /** Offset to the left as a fraction of the picture; the text ends there. */
  aside_mm?: number;
}

/** A label's corner above a place and within the window: beside the arrow it would cover the line or the spine. */
function above(
  node: HTMLElement,
  [x, y]: [number, number],
  left: number,
  width: number,
): [number, number] {
  const { offsetWidth: wide, offsetHeight: high } = node;
  const furthest = Math.max(left, left + width - wide);
  return [Math.min(Math.max(x - wide / 2, left), furthest), Math.max(0, y - high - 4)];
}

/** Labels over the canvas, hidden from screen readers because tables and texts contain the same. */
export class Labels {
  readonly #nodes: HTMLElement[] = [];
  #labels: readonly Label[] = [];

  constructor(private readonly layer: HTMLElement) {}

  set(labels: readonly Label[]): void {
    this.#labels = labels;
    while (this.#nodes.length > labels.length) this.#nodes.pop()?.remove();
    labels.forEach((label, index) => {
      const node = this.#nodes[index] ?? this.#add();
      const style = `label ${label.kind}`;
      if (node.className !== style) node.className = style;
      if (node.textContent !== label.text) node.textContent = label.text;
    });
  }

  place(camera: Camera, left: number, width: number, height: number, pixelsPerMm: number): void {
    const point = new Vector3();
    this.#labels.forEach((label, index) => {
      const node = this.#nodes[index];
      if (!node) return;
      point.set(...label.at).project(camera);
      const x =
        left +
        ((point.x + 1) / 2) * width +
        (label.shift?.[0] ?? 0) -
        (label.aside_mm ?? 0) * pixelsPerMm;
      const y = ((1 - point.y) / 2) * height + (label.shift?.[1] ?? 0);
      // Labels on the ground would leave the window at its lower edge.
      const within = label.kind === "axis" ? Math.min(y, height - node.offsetHeight) : y;
      const [atX, atY] = label.kind === "force" ? above(node, [x, y], left, width) : [x, within];
      const back = label.aside_mm === undefined ? "" : " translate(-100%, -50%)";
      node.style.transform = `translate(${atX.toFixed(1)}px, ${atY.toFixed(1)}px)${back}`;
    });
  }

  #add(): HTMLElement {
    const node = document.createElement("span");
    this.layer.append(node);
    this.#nodes.push(node);
    return node;
  }
}
