import { Mesh, MeshPhongMaterial, Vector3 } from "three";
import { expect, it } from "vitest";

import { spine } from "../../../e2e/model.fixture";
import type { Palette } from "../colour";
import { at, corner, type BodySize, type Point } from "../shapes";
import { Figure, Parts, placement } from "./figure";
import { archGeometry, bendDisc, bodyGeometry, discGeometry } from "./vertebra";

const BODY: BodySize = { level: "T7", width_mm: 30, depth_mm: 20, height_mm: 10 };
const BENT = spine((place) => 30 * place);

it("places a vertebra where the flat views have its corners", () => {
  const drawn = new Vector3(10, -15, 5).applyMatrix4(placement(BENT, 9)).toArray();
  corner(BENT, 9, BODY, [1, -1, 1]).forEach((value, axis) =>
    expect(at(drawn, axis)).toBeCloseTo(value, 9),
  );
});

it("tilts a vertebra with a positive tilt to the patient's right", () => {
  const up = new Vector3(0, 0, 1).transformDirection(placement(BENT, 14));
  expect(up.y).toBeLessThan(-0.4);
});

it("draws a body in its measured size, with the arch behind it", () => {
  const body = bodyGeometry(BODY);
  body.computeBoundingBox();
  const size = body.boundingBox?.getSize(new Vector3()) ?? new Vector3();
  // The concave back does not change width and height.
  expect(size.y).toBeCloseTo(30, 6);
  expect(size.z).toBeCloseTo(10, 6);
  expect(body.boundingBox?.max.x).toBeCloseTo(10, 6);
  expect(body.boundingBox?.min.x).toBeGreaterThanOrEqual(-10);
  const arch = archGeometry(BODY);
  arch.computeBoundingBox();
  expect(arch.boundingBox?.max.x).toBeLessThan(0);
  expect(arch.boundingBox?.min.x).toBeLessThan(-20);
});

it("draws the assumed arch translucent, and the body opaque", () => {
  const palette = { bone: "#ded7c8", force: "#ff8a80", measured: "#e6edf3" } as Palette;
  const figure = new Figure(new Parts([BODY]), palette);
  figure.dress({
    tone: "erect",
    faint: false,
    discs: null,
    contradicted: [],
    chosenJoint: null,
    chosenLevel: null,
  });
  const [body, arch] = at(figure.group.children, 0).children as Mesh[];
  expect((body?.material as MeshPhongMaterial).opacity).toBe(1);
  expect((arch?.material as MeshPhongMaterial).opacity).toBeLessThan(0.5);
});

it("fits a disc between the endplates of its two bodies", () => {
  const disc = discGeometry();
  const lower = (p: Point): Point => p;
  const upper = (p: Point): Point => [p[0], p[1], p[2] + 14];
  bendDisc(disc, [BODY, BODY], [lower, upper]);
  disc.computeBoundingBox();
  expect(disc.boundingBox?.min.z).toBeCloseTo(4.5, 5);
  expect(disc.boundingBox?.max.z).toBeCloseTo(9.5, 5);
});
