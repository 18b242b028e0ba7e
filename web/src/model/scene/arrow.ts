import {
  type BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  Vector3,
} from "three";

import type { Point } from "../shapes";

const UP = new Vector3(0, 1, 0);

/** Half the width of an arrow's head, as a part of its length. */
export const HEAD_GIRTH = 0.36;

/** Opacity of a line where the spine hides it. */
export const HIDDEN = 0.3;

/** A straight rod between two points. */
export class Rod {
  readonly mesh: Mesh<CylinderGeometry, MeshBasicMaterial>;
  ends: [Vector3, Vector3] = [new Vector3(), new Vector3()];
  radius_mm = 0;
  #ghost: Mesh<CylinderGeometry, MeshBasicMaterial> | null = null;

  constructor(geometry: CylinderGeometry) {
    this.mesh = new Mesh(geometry, new MeshBasicMaterial());
  }

  /** Drawn faintly through other objects, so that a line neither covers the spine nor disappears behind it. */
  shineThrough(): void {
    const ghost = new MeshBasicMaterial({ depthTest: false, transparent: true, opacity: HIDDEN });
    this.#ghost = new Mesh(this.mesh.geometry, ghost);
    this.#ghost.renderOrder = 1;
    this.mesh.add(this.#ghost);
  }

  paint(colour: string): void {
    this.mesh.material.color.set(colour);
    this.#ghost?.material.color.set(colour);
  }

  dispose(): void {
    this.mesh.material.dispose();
    this.#ghost?.material.dispose();
  }

  set(from: Vector3, to: Vector3, radius_mm: number): void {
    this.ends = [from.clone(), to.clone()];
    this.radius_mm = radius_mm;
    const axis = to.clone().sub(from);
    const length = Math.max(axis.length(), 1e-6);
    this.mesh.position.copy(from).addScaledVector(axis, 0.5);
    this.mesh.quaternion.copy(new Quaternion().setFromUnitVectors(UP, axis.normalize()));
    this.mesh.scale.set(radius_mm, length, radius_mm);
  }
}

/** An arrow from a point to its tip. */
export class Arrow {
  readonly group = new Group();
  readonly shaft: Rod;
  headEnds: [Vector3, Vector3] = [new Vector3(), new Vector3()];
  readonly #head: Mesh<ConeGeometry, MeshBasicMaterial>;

  constructor(rod: CylinderGeometry, head: ConeGeometry, { isOnTop = false } = {}) {
    this.shaft = new Rod(rod);
    this.#head = new Mesh(head, new MeshBasicMaterial());
    // The dragged handle must stay visible in front of the spine.
    if (isOnTop) [this.shaft.mesh, this.#head].forEach(putOnTop);
    this.group.add(this.shaft.mesh, this.#head);
  }

  set(from: Point, tip: Point, colour: string): void {
    const [start, end] = [new Vector3(...from), new Vector3(...tip)];
    const axis = end.clone().sub(start);
    const length = axis.length();
    this.group.visible = length > 0.5;
    if (!this.group.visible) return;
    axis.normalize();
    const head = Math.min(14, length * 0.5);
    this.headEnds = [end.clone().addScaledVector(axis, -head), end.clone()];
    this.#head.position.copy(end).addScaledVector(axis, -head / 2);
    this.#head.quaternion.copy(new Quaternion().setFromUnitVectors(UP, axis));
    this.#head.scale.set(head * HEAD_GIRTH, head, head * HEAD_GIRTH);
    this.shaft.set(start, end.clone().addScaledVector(axis, -head * 0.9), 1.5);
    for (const material of [this.shaft.mesh.material, this.#head.material])
      material.color.set(colour);
  }

  dispose(): void {
    this.shaft.mesh.material.dispose();
    this.#head.material.dispose();
  }
}

function putOnTop(mesh: Mesh<BufferGeometry, MeshBasicMaterial>): void {
  mesh.material.depthTest = false;
  mesh.material.transparent = true;
  mesh.renderOrder = 1;
}
