import type { Api } from "../src/api/types";
import { LEVELS } from "./levels";

type Shape = Api<"Shape">;

const WIDTHS = [48, 46, 44, 42, 40.5, 37, 33.6, 31.8, 30, 28.4, 27.2, 26, 25.2, 25.2, 26];
const DEPTHS = [
  35.5, 35.2, 34.6, 34.1, 32.8, 31.9, 30.5, 29.3, 27.9, 27.4, 26, 24.3, 23.3, 22.7, 19.6,
];
const HEIGHTS = [
  24.1, 23.8, 24.3, 23.8, 22.7, 21.3, 20.2, 19.3, 18.7, 18.2, 17.4, 16.2, 16.2, 15.7, 15.6,
];
const PITCHES = [-17, -7, -2, 2, 3, 1, -2, -3, -2, 2, 6, 10, 13, 15, 16];

/** A synthetic spine whose tilts are given by a function of the level's place, from 0 at L4 to 1 at T2. */
export function spine(tilt_deg: (place: number) => number): Shape {
  const shape: Shape = { midpoints_mm: [], rotations: [], joints_mm: [] };
  let at = [0, 0, 0];
  LEVELS.forEach((_, i) => {
    const tilt = (tilt_deg(i / 14) * Math.PI) / 180;
    const pitch = (PITCHES[i]! * Math.PI) / 180;
    const [ct, st, cp, sp] = [Math.cos(tilt), Math.sin(tilt), Math.cos(pitch), Math.sin(pitch)];
    // Columns: anterior, left, cranial of a turn about x, then about y.
    const turn = [cp, 0, sp, st * sp, ct, -st * cp, -ct * sp, st, ct * cp];
    const cranial = [turn[2]!, turn[5]!, turn[8]!];
    const anterior = [turn[0]!, turn[3]!, turn[6]!];
    const rise = HEIGHTS[i]! / 2 + 2.5;
    if (i > 0) at = at.map((v, k) => v + cranial[k]! * rise);
    shape.midpoints_mm.push(at as [number, number, number]);
    shape.rotations.push(turn as Shape["rotations"][number]);
    if (i < 14) {
      const joint = at.map(
        (v, k) => v + (cranial[k]! * HEIGHTS[i]!) / 2 - (anterior[k]! * DEPTHS[i]!) / 2,
      );
      shape.joints_mm.push(joint as [number, number, number]);
    }
    at = at.map((v, k) => v + cranial[k]! * rise);
  });
  return shape;
}

/** Main thoracic curve to the right with a lumbar one to the left; `bend` bends the whole spine. */
function curved(size: number, bend: number): Shape {
  return spine((u) => size * (Math.sin(2 * Math.PI * u * 1.05) - 0.1 * u) + bend * u);
}

const ERECT = curved(24, 0);

function path(size: number, bend: number): Shape[] {
  return [0, 0.25, 0.5, 0.75, 1].map((part) => curved(24 + (size - 24) * part, bend * part));
}

/** The simulated films: the last shape of their path, and their force. */
const FILMS = [
  { posture: "left_bending", fitted: true, size: 14, bend: -38, pull: "1.42" },
  { posture: "right_bending", fitted: true, size: 10, bend: 36, pull: "1.17" },
  { posture: "neutral", fitted: false, size: 17, bend: 2, pull: "0.40" },
  { posture: "traction", fitted: false, size: 9, bend: 1, pull: "1.90" },
] as const;

function simulated(film: (typeof FILMS)[number], shift: number): Api<"SimulatedPosture"> {
  const { posture, fitted } = film;
  const shapes = path(film.size + shift, film.bend);
  const top = shapes.at(-1)!.midpoints_mm[14]!;
  return {
    posture,
    fitted,
    converged: true,
    status_text: "converged, residual 3·10⁻¹⁰ N·mm",
    force_text: `pull of ${film.pull} at the gauge, up along the line`,
    line_point_mm: [top[0]!, top[1]! * (0.6 - shift / 20), top[2]!],
    line_direction: [0, Math.sin(0.12 + shift / 30), Math.cos(0.12 + shift / 30)],
    path: shapes,
    errors: LEVELS.map((level, i) => ({
      level,
      error_mm: i === 0 ? 0 : 0.6 + 2.1 * Math.abs(Math.sin(i * 0.9)),
    })),
    mean_error_mm: fitted ? 1.6 : 3.4,
    contradictions:
      posture === "left_bending" ? ["T8/T7 turns against the force on the left bending film"] : [],
  };
}

function line(kind: Api<"LineKindName">, label: string, shift: number): Api<"LineModelView"> {
  const joints = ERECT.joints_mm.map((_, i) => ({
    label: `${LEVELS[i]}/${LEVELS[i + 1]}`,
    relative: Math.min(1, Math.max(0, 0.5 + 0.5 * Math.sin(i * 0.55 - 1 + shift))),
    text: `lateral ${(1.2 + i * 0.13).toFixed(2)} × library, flexion 1.00 × library, axial 1.00 × library; ratios only`,
    contradicted_in: i === 8 ? (["left_bending"] as Api<"PostureName">[]) : [],
  }));
  return {
    kind,
    label,
    converged: true,
    status_text: "fit converged after 9 steps, 4 films simulated",
    multipliers: [
      {
        label: "thoracolumbar/lumbar",
        factor: 0.71,
        identified: "ratio_only",
        text: "known as a ratio to the others: no force was measured",
      },
      {
        label: "main thoracic",
        factor: 2.84,
        identified: "contradicted",
        text: "T8/T7 turns against the force on the left bending film",
      },
      {
        label: "proximal thoracic",
        factor: 0.1,
        identified: "bound",
        text: "the fit ended at the lower bound of 0.1",
      },
    ],
    joints,
    postures: FILMS.map((film) => simulated(film, shift)),
    fitted_error_mm: 1.6 + shift / 4,
    held_out_error_mm: 3.4 + shift / 2,
  };
}

/** A model view with a contradiction, a bound and a line without a result. */
export function modelView(): Api<"ModelView"> {
  const failed = line("iliac_line", "iliac line, through T2", 3);
  failed.converged = false;
  failed.status_text =
    "not converged: the left bending film passes a limit point at 0.62 of the force";
  failed.fitted_error_mm = null;
  failed.held_out_error_mm = null;
  for (const multiplier of failed.multipliers) multiplier.identified = "not_converged";
  for (const one of failed.postures.filter((p) => p.posture === "left_bending")) {
    one.converged = false;
    one.status_text = "limit point passed at 0.62 of the force; residual 41 N·mm";
    one.mean_error_mm = null;
    one.errors = [];
  }
  return {
    study: "phantom-rod-01",
    synthetic: true,
    profile_text:
      "sagittal profile: template of 458 adolescents with scoliosis, kyphosis T5–T12 24.9°, lordosis L1–L5 46.4°; not measured on this patient",
    gauge_text:
      "only ratios are known: forces and stiffness are relative to the geometric mean of the multipliers",
    length_unit: "mm (patient)",
    force_symbol: "rel. units",
    force_unit_text: "a relative force of 1, not 1 newton",
    bodies: LEVELS.map((level, i) => ({
      level,
      width_mm: WIDTHS[i]!,
      depth_mm: DEPTHS[i]!,
      height_mm: HEIGHTS[i]!,
    })),
    pitch_from: LEVELS.map(() => "population" as const),
    erect: ERECT,
    measured: [
      { posture: "left_bending", shape: curved(15, -41) },
      { posture: "right_bending", shape: curved(11, 39) },
      { posture: "neutral", shape: curved(18, 5) },
      { posture: "traction", shape: curved(8, 4) },
    ],
    lines: [
      line("inflection_line", "inflection line", 0),
      failed,
      line("estimated_line", "estimated line", 1.5),
    ],
    verdict: [
      "The inflection line explains the fitted films best: 1.6 mm against 2.0 mm for the estimated line.",
      "The iliac line has no result: its fit did not converge.",
    ],
    notices: [
      {
        severity: "contradiction",
        code: "joint_against_force",
        posture: "left_bending",
        level: "T8",
        text: "T8/T7 turns against the force on the left bending film: no positive stiffness explains it",
      },
      {
        severity: "warning",
        code: "bound_hit",
        posture: null,
        level: null,
        text: "proximal thoracic multiplier ended at its lower bound of 0.1",
      },
    ],
  };
}

/** Response to a load: the spine bends towards the arrow; above a force of 120 it has no equilibrium. */
export function loadAnswer(request: Api<"LoadRequest">): Api<"LoadAnswer"> {
  const from = ERECT.midpoints_mm[LEVELS.indexOf(request.level)]!;
  const force = request.tip_mm.map((v, i) => v - from[i]!);
  const size = Math.hypot(...force);
  const part = Math.min(1, 120 / Math.max(size, 1e-9));
  return {
    converged: part === 1,
    status_text:
      part === 1
        ? "Equilibrium, reached from the erect spine"
        : `Not a result: no equilibrium is near. The shape at ${(part * 100).toFixed(0)} % of the load is shown`,
    load_text: `Relative force ${Math.abs(force[1]!).toFixed(0)} to the patient's ${force[1]! >= 0 ? "left" : "right"} on ${request.level}`,
    part,
    shape: curved(24, -force[1]! * 0.4 * part),
    texts: [
      `largest displacement ${(size * 0.8 * part).toFixed(1)} mm at T2`,
      "main thoracic Cobb 48.2° → 41.0°",
    ],
  };
}
