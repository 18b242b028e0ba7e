import {
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshPhongMaterial,
  SphereGeometry,
  Vector3,
} from "three";

import type { Palette } from "../colour";
import { at, placed, type BodySize, type Point, type Shape } from "../shapes";
import { archGeometry, bendDisc, bodyGeometry, discGeometry, rimGeometry } from "./vertebra";

/** Kind of a spine in the picture. */
export type Tone = "erect" | "measured" | "simulated" | "not_a_result";

/** Geometries of all levels, shared by the spines of a picture. */
export class Parts {
  readonly bodies: BufferGeometry[];
  readonly arches: BufferGeometry[];
  readonly rims: BufferGeometry[];
  readonly joint = new SphereGeometry(1, 12, 8);

  constructor(readonly sizes: readonly BodySize[]) {
    this.bodies = sizes.map(bodyGeometry);
    this.arches = sizes.map(archGeometry);
    this.rims = sizes.map(rimGeometry);
  }

  dispose(): void {
    for (const part of [...this.bodies, ...this.arches, ...this.rims, this.joint]) part.dispose();
  }
}

/** The placement of a vertebra: its rotation is given row by row, and its columns are the vertebra's own axes. */
export function placement(shape: Shape, index: number): Matrix4 {
  const turn = at(shape.rotations, index);
  const axis = (column: number): Vector3 =>
    new Vector3(at(turn, column), at(turn, column + 3), at(turn, column + 6));
  return new Matrix4()
    .makeBasis(axis(0), axis(1), axis(2))
    .setPosition(...(at(shape.midpoints_mm, index) as Point));
}

/** How one spine is drawn. */
export interface FigureStyle {
  tone: Tone;
  /** Transparent with drawn rims, over another spine. */
  faint: boolean;
  /** Colour of each disc; without it discs are grey. */
  discs: readonly string[] | null;
  /** Joints that turn against the force. */
  contradicted: readonly boolean[];
  /** Selected joint. */
  chosenJoint: number | null;
  /** Loaded vertebra. */
  chosenLevel: number | null;
}

const JOINT_RADIUS_MM = 2.2;
const SHINE = { shininess: 18, specular: 0x222222 };
/** Arches and processes are assumed: the films do not show them. */
const ARCH_OPACITY = 0.4;

/** One spine in the picture. */
export class Figure {
  readonly group = new Group();
  readonly #vertebrae: Group[] = [];
  readonly #bodyMeshes: Mesh[] = [];
  readonly #discs: Mesh<BufferGeometry, MeshPhongMaterial>[] = [];
  readonly #joints: Mesh<BufferGeometry, MeshPhongMaterial>[] = [];
  readonly #bone = new MeshPhongMaterial(SHINE);
  readonly #arch = new MeshPhongMaterial(SHINE);
  readonly #fixed = new MeshPhongMaterial(SHINE);
  readonly #chosen = new MeshPhongMaterial(SHINE);
  /** Striped on shapes that are not results. */
  readonly #striped = [this.#bone, this.#arch, this.#fixed, this.#chosen];
  readonly #rim = new LineBasicMaterial();
  readonly #arches: Mesh[] = [];
  readonly #rims: LineSegments[] = [];
  #hatched = false;
  #shape: Shape | null = null;

  constructor(
    private readonly parts: Parts,
    private readonly palette: Palette,
  ) {
    parts.sizes.forEach((_, index) => this.#addVertebra(index));
    for (let joint = 0; joint + 1 < parts.sizes.length; joint += 1) this.#addJoint(joint);
    for (const material of this.#striped) hatch(material, () => this.#hatched);
    fade(this.#arch, ARCH_OPACITY);
  }

  /** Objects that a pointer can hit: bodies and discs, with `level` or `joint` in their user data. */
  get targets(): Mesh[] {
    return [...this.#bodyMeshes, ...this.#discs, ...this.#joints];
  }

  pose(shape: Shape): void {
    if (shape === this.#shape) return;
    this.#shape = shape;
    this.#vertebrae.forEach((vertebra, index) => {
      vertebra.matrix.copy(placement(shape, index));
      vertebra.matrixWorldNeedsUpdate = true;
    });
    this.#joints.forEach((joint, index) => {
      const [x, y, z] = at(shape.joints_mm, index);
      joint.position.set(x!, y!, z!);
    });
    this.#discs.forEach((disc, index) =>
      bendDisc(
        disc.geometry,
        [at(this.parts.sizes, index), at(this.parts.sizes, index + 1)],
        [(local) => placed(shape, index, local), (local) => placed(shape, index + 1, local)],
      ),
    );
  }

  dress(style: FigureStyle): void {
    const bone = boneColour(this.palette, style.tone);
    this.#bone.color.copy(bone);
    this.#arch.color.copy(bone).multiplyScalar(0.62);
    this.#fixed.color.copy(bone).multiplyScalar(0.45);
    this.#chosen.color.set(this.palette.force).lerp(bone, 0.45);
    this.#rim.color.set(this.palette.measured);
    this.#setHatched(style.tone === "not_a_result");
    for (const material of [this.#bone, this.#fixed]) fade(material, style.faint ? 0.3 : 1);
    this.#rims.forEach((rim) => (rim.visible = style.faint));
    this.#arches.forEach((arch) => (arch.visible = !style.faint));
    this.#bodyMeshes.forEach((body, index) => {
      if (index === style.chosenLevel) body.material = this.#chosen;
      else body.material = index === 0 ? this.#fixed : this.#bone;
    });
    this.#discs.forEach((disc, index) =>
      this.#dressJoint(disc, at(this.#joints, index), index, style),
    );
  }

  dispose(): void {
    for (const disc of this.#discs) disc.geometry.dispose();
    const own = [...this.#discs, ...this.#joints].map(({ material }) => material);
    for (const material of [...this.#striped, this.#rim, ...own]) material.dispose();
  }

  #dressJoint(
    disc: Mesh<BufferGeometry, MeshPhongMaterial>,
    joint: Mesh<BufferGeometry, MeshPhongMaterial>,
    index: number,
    style: FigureStyle,
  ): void {
    const isChosen = index === style.chosenJoint;
    const isContradicted = style.contradicted[index] ?? false;
    disc.visible = !style.faint;
    joint.visible = !style.faint;
    const colour = style.tone === "not_a_result" ? null : style.discs?.[index];
    disc.material.color.set(colour ?? this.palette.quiet);
    disc.material.emissive.set(colour ?? this.palette.background);
    disc.material.emissiveIntensity = isChosen ? 0.9 : 0.35;
    joint.material.color.set(isContradicted ? this.palette.contradiction : this.palette.measured);
    joint.material.emissive.copy(joint.material.color);
    joint.scale.setScalar(JOINT_RADIUS_MM * (isContradicted ? 1.9 : 1) * (isChosen ? 1.5 : 1));
  }

  #setHatched(hatched: boolean): void {
    if (hatched === this.#hatched) return;
    this.#hatched = hatched;
    for (const material of this.#striped) material.needsUpdate = true;
  }

  #addVertebra(index: number): void {
    const vertebra = new Group();
    vertebra.matrixAutoUpdate = false;
    const body = new Mesh(at(this.parts.bodies, index), this.#bone);
    body.userData.level = index;
    const arch = new Mesh(at(this.parts.arches, index), this.#arch);
    const rim = new LineSegments(at(this.parts.rims, index), this.#rim);
    vertebra.add(body, arch, rim);
    this.#vertebrae.push(vertebra);
    this.#bodyMeshes.push(body);
    this.#arches.push(arch);
    this.#rims.push(rim);
    this.group.add(vertebra);
  }

  #addJoint(index: number): void {
    const disc = new Mesh(discGeometry(), new MeshPhongMaterial({ ...SHINE, side: DoubleSide }));
    const joint = new Mesh(
      this.parts.joint,
      new MeshPhongMaterial({ ...SHINE, emissiveIntensity: 0.4 }),
    );
    disc.userData.joint = index;
    joint.userData.joint = index;
    this.#discs.push(disc);
    this.#joints.push(joint);
    this.group.add(disc, joint);
  }
}

function fade(material: MeshPhongMaterial, opacity: number): void {
  const transparent = opacity < 1;
  if (material.transparent !== transparent) material.needsUpdate = true;
  material.transparent = transparent;
  material.opacity = opacity;
  material.depthWrite = !transparent;
}

/** Stripes mark shapes that are not results, also in print and for colour-blind readers. */
function hatch(material: MeshPhongMaterial, isOn: () => boolean): void {
  material.customProgramCacheKey = () => (isOn() ? "hatched" : "plain");
  material.onBeforeCompile = (shader) => {
    if (!isOn()) return;
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <color_fragment>",
      `#include <color_fragment>
      if (mod(gl_FragCoord.x + gl_FragCoord.y, 12.0) < 5.0) diffuseColor.rgb *= 0.25;`,
    );
  };
}

/** The colour of the bodies of a spine. */
export function boneColour(palette: Palette, tone: Tone): Color {
  if (tone === "simulated") return new Color(palette.boneSimulated);
  return new Color(tone === "not_a_result" ? palette.boneDoubtful : palette.bone);
}
