import {
  BufferGeometry,
  CylinderGeometry,
  Float32BufferAttribute,
  GridHelper,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Matrix4,
  Mesh,
  MeshPhongMaterial,
} from "three";

import type { BodySize, Point } from "../shapes";
import type { Label } from "./labels";

/** Side of a square of the grid on the ground. */
const GRID_MM = 50;

const AXIS_MM = 90;

/** Ground below the spine: the plate at L4, a grid, and the patient's directions. */
export class Ground {
  readonly group = new Group();
  readonly #height_mm: number;
  readonly #grid: GridHelper;
  readonly #plate: Mesh<CylinderGeometry, MeshPhongMaterial>;
  readonly #axes: LineSegments<BufferGeometry, LineBasicMaterial>;

  /** `placement` is the lowest body's, which is fixed. */
  constructor(lowest: BodySize, placement: Matrix4, colours: { line: string; quiet: string }) {
    const under = -lowest.height_mm / 2;
    this.#height_mm = under - 22;
    this.#grid = new GridHelper(8 * GRID_MM, 8, colours.quiet, colours.line);
    this.#grid.rotateX(Math.PI / 2);
    this.#grid.position.z = this.#height_mm;
    this.#plate = new Mesh(
      new CylinderGeometry(lowest.width_mm * 0.62, lowest.width_mm * 0.72, 8, 40),
      new MeshPhongMaterial({ color: colours.quiet, shininess: 4 }),
    );
    this.#plate.geometry.rotateX(Math.PI / 2).translate(0, 0, under - 5);
    this.#plate.applyMatrix4(placement);
    this.#axes = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ color: colours.quiet }),
    );
    const z = this.#height_mm + 0.5;
    this.#axes.geometry.setAttribute(
      "position",
      new Float32BufferAttribute([0, -AXIS_MM, z, 0, AXIS_MM, z, 0, 0, z, AXIS_MM, 0, z], 3),
    );
    this.group.add(this.#grid, this.#plate, this.#axes);
  }

  /** Labels of the directions that are not parallel to the view. */
  labels(toward: Point): Label[] {
    const [x, y, z] = [AXIS_MM, AXIS_MM, this.#height_mm];
    const all: (Label & { axis: 0 | 1 })[] = [
      { text: "patient’s left", at: [0, y, z], axis: 1, kind: "axis", shift: [0, 14] },
      { text: "patient’s right", at: [0, -y, z], axis: 1, kind: "axis", shift: [0, 14] },
      { text: "front", at: [x, 0, z], axis: 0, kind: "axis", shift: [0, 14] },
    ];
    return all.filter((label) => Math.abs(toward[label.axis]) < 0.85);
  }

  dispose(): void {
    this.#grid.dispose();
    for (const part of [this.#plate, this.#axes]) {
      part.geometry.dispose();
      part.material.dispose();
    }
  }
}
