import { BufferGeometry, Float32BufferAttribute, Matrix4, SphereGeometry, Vector3 } from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import { at, type BodySize, type Point } from "../shapes";

/** Profile of a body from the lower to the upper endplate: height relative to half its height, width relative to its rim. */
const PROFILE: readonly [number, number][] = [
  [-0.93, 0],
  [-0.94, 0.5],
  [-0.985, 0.82],
  [-1, 0.9],
  [-0.97, 0.975],
  [-0.88, 1],
  [-0.7, 0.965],
  [-0.35, 0.895],
  [0, 0.87],
  [0.35, 0.895],
  [0.7, 0.965],
  [0.88, 1],
  [0.97, 0.975],
  [1, 0.9],
  [0.985, 0.82],
  [0.94, 0.5],
  [0.93, 0],
];

const AROUND = 32;

/** A point of the rim at an angle from the front, `[x, y]`: fuller than an ellipse, and concave at the back. */
function rim(body: BodySize, angle: number): [number, number] {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const rounded = (v: number): number => Math.sign(v) * Math.abs(v) ** 0.88;
  const hollow = c < 0 ? 1 - 0.2 * Math.exp(-((s / 0.45) ** 2)) : 1;
  return [(rounded(c) * hollow * body.depth_mm) / 2, (rounded(s) * body.width_mm) / 2];
}

const rimsKnown = new WeakMap<BodySize, [number, number][]>();

/** The points of a rim, one per step around it. */
export function rimPoints(body: BodySize): [number, number][] {
  const points =
    rimsKnown.get(body) ??
    Array.from({ length: AROUND }, (_, step) => rim(body, (step / AROUND) * 2 * Math.PI));
  rimsKnown.set(body, points);
  return points;
}

/** A surface through rings of points, the lowest first. */
function ringed(rings: number, positions: number[] | Float32Array): BufferGeometry {
  const indices: number[] = [];
  for (let ring = 1; ring < rings; ring += 1) {
    for (let step = 0; step < AROUND; step += 1) {
      const next = (step + 1) % AROUND;
      const [low, high] = [(ring - 1) * AROUND, ring * AROUND];
      indices.push(low + step, low + next, high + next, low + step, high + next, high + step);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setIndex(indices);
  return geometry;
}

/** The body in its own axes: x anterior, y left, z cranial, its midpoint at zero. */
export function bodyGeometry(body: BodySize): BufferGeometry {
  const positions = PROFILE.flatMap(([height, width]) =>
    rimPoints(body).flatMap(([x, y]) => [x * width, y * width, (height * body.height_mm) / 2]),
  );
  const geometry = ringed(PROFILE.length, positions);
  geometry.computeVertexNormals();
  return geometry;
}

/** The rims of both endplates, as pairs of points. */
export function rimGeometry(body: BodySize): BufferGeometry {
  const positions: number[] = [];
  for (const side of [-1, 1]) {
    for (let step = 0; step < AROUND; step += 1) {
      for (const end of [step, step + 1]) {
        const [x, y] = at(rimPoints(body), end % AROUND);
        positions.push(x, y, (side * 0.95 * body.height_mm) / 2);
      }
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  return geometry;
}

/**
 * Arch and processes behind the body. They show which side is posterior, in proportion to the body; the films
 * do not show them.
 */
export function archGeometry(body: BodySize): BufferGeometry {
  const [d, w, h] = [body.depth_mm, body.width_mm, body.height_mm];
  const back = -d / 2;
  const isLumbar = body.level.startsWith("L");
  const parts: BufferGeometry[] = [];
  const add = (from: Point, to: Point, across: number, along: number): void => {
    parts.push(strut(from, to, across, along));
  };
  for (const side of [-1, 1]) {
    const pedicle: Point = [back - 0.3 * d, side * 0.3 * w, 0.2 * h];
    const lamina: Point = [back - 0.66 * d, side * 0.03 * w, 0];
    add([back + 0.1 * d, side * 0.3 * w, 0.2 * h], pedicle, 0.09 * w, 0.2 * h);
    add(pedicle, lamina, 0.07 * w, 0.22 * h);
    // Lumbar processes point to the side, thoracic ones back as well.
    const tip: Point = [back - (isLumbar ? 0.32 : 0.5) * d, side * 0.66 * w, 0.24 * h];
    add([back - 0.3 * d, side * 0.28 * w, 0.18 * h], tip, 0.055 * w, 0.1 * h);
  }
  // Lumbar spinous processes are flat, thoracic ones slope down.
  const root: Point = [back - 0.58 * d, 0, 0];
  const tip: Point = [back - 1.2 * d, 0, (isLumbar ? -0.22 : -0.8) * h];
  add(root, tip, 0.05 * w, (isLumbar ? 0.36 : 0.2) * h);
  const merged = mergeGeometries(parts);
  parts.forEach((part) => part.dispose());
  return merged;
}

/** A tapered rod between two points with thickness `across` sideways and `along` in height. */
function strut(from: Point, to: Point, across: number, along: number): BufferGeometry {
  const [start, end] = [new Vector3(...from), new Vector3(...to)];
  const y = end.clone().sub(start);
  const half = y.length() / 2;
  y.normalize();
  const x = y.clone().cross(new Vector3(0, 0, 1));
  if (x.lengthSq() < 1e-6) x.set(0, 1, 0);
  x.normalize();
  const geometry = new SphereGeometry(1, 8, 6);
  // Blunter ends than an ellipsoid's.
  const points = geometry.getAttribute("position");
  for (let i = 0; i < points.count; i += 1) {
    const girth = Math.sqrt(1 + points.getY(i) ** 2);
    points.setXYZ(i, points.getX(i) * girth, points.getY(i), points.getZ(i) * girth);
  }
  geometry.computeVertexNormals();
  geometry.scale(across, half * 1.2, along);
  geometry.applyMatrix4(new Matrix4().makeBasis(x, y, x.clone().cross(y)));
  const middle = start.add(end).multiplyScalar(0.5);
  return geometry.translate(middle.x, middle.y, middle.z);
}

/** The disc between two bodies: rings from the lower endplate to the upper one, to be filled by `bendDisc`. */
export const discGeometry = (): BufferGeometry =>
  ringed(DISC_RINGS.length, new Float32Array(DISC_RINGS.length * AROUND * 3));

/** Height between the endplates (0 to 1) and width relative to the rims: the disc bulges slightly. */
const DISC_RINGS: readonly [number, number][] = [
  [0, 0],
  [0, 0.98],
  [0.25, 1.05],
  [0.5, 1.075],
  [0.75, 1.05],
  [1, 0.98],
  [1, 0],
];

/** Places a disc's rings between two endplates, given as placed points of the lower and upper body. */
export function bendDisc(
  geometry: BufferGeometry,
  bodies: [BodySize, BodySize],
  place: [(local: Point) => Point, (local: Point) => Point],
): void {
  const positions = geometry.getAttribute("position");
  const rims = bodies.map(rimPoints);
  let index = 0;
  for (const [share, width] of DISC_RINGS) {
    for (let step = 0; step < AROUND; step += 1) {
      const end = (which: 0 | 1): Point => {
        const [x, y] = at(at(rims, which), step);
        const z = ((which === 0 ? 0.9 : -0.9) * bodies[which].height_mm) / 2;
        return place[which]([x * width, y * width, z]);
      };
      const [low, high] = [end(0), end(1)];
      positions.setXYZ(
        index,
        low[0] + (high[0] - low[0]) * share,
        low[1] + (high[1] - low[1]) * share,
        low[2] + (high[2] - low[2]) * share,
      );
      index += 1;
    }
  }
  positions.needsUpdate = true;
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
}
