import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { POSTURES } from "./postures";

// Synthetic answers for page states that are hard to reach with the program.

export function film(
  number: number,
  posture: Api<"PostureName">,
  plane: Api<"SpacingPlaneName"> = "patient",
): Api<"FilmSummary"> {
  return {
    film: number,
    posture,
    image: {
      columns: 2140,
      rows: 4000,
      pixel_aspect: 1,
      is_lateral: false,
      patient_left: "image_right",
      plane,
      spacing_text: "0.143 × 0.143 mm (patient), by a ball (± 0.6 %)",
      inverted: false,
    },
    checked: false,
    revision: 0,
    readings: [
      {
        reading: number,
        observer: "ab",
        repeat: 1,
        mine: true,
        finished: false,
        complete_levels: 15,
      },
    ],
  };
}

export function study(id: string, more: Partial<Api<"StudySummary">> = {}): Api<"StudySummary"> {
  return {
    id,
    label: null,
    synthetic: false,
    archived: false,
    revision: 0,
    role: "admin",
    status: "to_mark",
    status_text: "no film is marked",
    films: POSTURES.map((posture, index) => film(index + 1, posture)),
    curve: null,
    warnings: 0,
    contradictions: 0,
    changed_ms: Date.UTC(2026, 4, 17, 9, 12),
    ...more,
  };
}

const LABELS = ["pilot", "before brace", null, "second opinion", null];
const STATUSES: [Api<"StudyStatus">, string][] = [
  [
    "modelled",
    "a line predicts films better than without mechanics, and the bends do not reject it",
  ],
  ["unsupported", "the bends reject every line of action"],
  ["measured", "the erect film is measured; no bending film is"],
  ["marking", "12 of 15 vertebrae on the erect film"],
  ["to_mark", "no film is marked"],
  ["not_converged", "iliac line: the fit ended without converging"],
  ["refused", "T8 lies above T7 on the erect film"],
  ["blinded", "7 of 20 readings are done"],
];

/** A large list of studies. */
export function manyStudies(count: number): Api<"StudySummary">[] {
  return Array.from({ length: count }, (_, index) => {
    const [status, status_text] = STATUSES[index % STATUSES.length] ?? STATUSES[0]!;
    const size_deg = 22 + ((index * 7.3) % 41);
    const isMeasured = ["modelled", "unsupported", "measured", "not_converged"].includes(status);
    const filmed = index % 4 === 3 ? POSTURES.slice(0, 3) : POSTURES;
    return study(`S-${String(count - index).padStart(3, "0")}`, {
      label: LABELS[index % LABELS.length] ?? null,
      synthetic: index % 6 === 0,
      status,
      status_text,
      films: filmed.map((posture, place) =>
        film(index * 5 + place, posture, index % 9 === 4 ? "pixels" : undefined),
      ),
      curve: isMeasured
        ? {
            lenke: "1",
            size_deg,
            is_cobb: true,
            region: "main thoracic",
            convex: "right",
            text: `Lenke 1, main thoracic ${size_deg.toFixed(1)}° convex right (T5–T12)`,
          }
        : null,
      warnings: index % 3,
      contradictions: status === "refused" ? 1 : 0,
      changed_ms: Date.UTC(2026, 4, 17, 9, 12) - index * 40_000_000,
    });
  });
}

/** Answers a path with a body. */
export async function answerWith(
  page: Page,
  path: string,
  body: unknown,
  status = 200,
): Promise<void> {
  await page.route(
    (url) => url.pathname === path,
    (route) => route.fulfill({ json: body, status }),
  );
}

/** The answer for a film that states nothing about its patient. */
export function upload(id: string, more: Partial<Api<"UploadView">>): Api<"UploadView"> {
  return {
    upload: id,
    format: "DICOM, JPEG-LS lossless",
    columns: 2140,
    rows: 4000,
    pixel_aspect: 1,
    is_synthetic: false,
    notices: [],
    ...more,
  };
}

/** Answers for five files: complete, partial, empty, not a picture, lateral view. */
export function uploads(): (Api<"UploadView"> | Api<"Problem">)[] {
  const spacing = { column_mm: 0.143, row_mm: 0.143 };
  return [
    upload("u1", {
      posture: "erect",
      patient_left: "image_right",
      spacing: {
        ...spacing,
        plane: "patient",
        text: "0.143 × 0.143 mm (patient), by a ball (± 0.6 %)",
      },
      is_synthetic: true,
    }),
    upload("u2", {
      posture: "left_bending",
      spacing: {
        ...spacing,
        plane: "detector",
        text: "0.143 × 0.143 mm (detector), as the file says",
      },
      notices: [
        {
          severity: "warning",
          code: "burned_in",
          text: "there may be text burned into the picture: it could be a patient's name",
        },
      ],
    }),
    upload("u3", { format: "PNG" }),
    { code: "film", message: "this is not a picture: the format of its first bytes is unknown" },
    upload("u5", { posture: "lateral", patient_left: "image_right" }),
  ];
}

/** A cohort with everything that the page can show. */
export function cohort(): Api<"CohortView"> {
  const whiskers_text =
    "Whiskers reach to the last value within 1.5 interquartile ranges of the box.";
  return {
    synthetic: true,
    mixed: true,
    rows: manyStudies(9).map((study, index) => cohortRow(study, index)),
    charts: [
      {
        title: "Location error on films that were held out",
        axis: "location error (mm)",
        whiskers_text,
        boxes: [
          box("Inflection line", [0.4, 1.8, 3.1, 4.6, 8.2], [10.2, 11.9]),
          box("Iliac line", [1.4, 3.8, 6.1, 9.6, 15.2]),
          box("Estimated line", [0.3, 1.2, 2.1, 3.6, 6.2], [9.1]),
        ],
      },
      {
        title: "Distance from inflections to least-rotating segments",
        axis: "distance (mm)",
        whiskers_text,
        boxes: [
          box("Left bending, upper", [-12, -4, 1, 5, 14], [22]),
          box("Right bending, upper", [-14, -6, -1, 4, 11]),
        ],
      },
    ],
    comparisons: [
      {
        label: "Inflection line against iliac line, location error",
        pooled_text: "3.1 mm against 6.1 mm; paired t, n = 420, p < 0.001 (one-sided)",
        by_patient_text: "2.9 mm less (95 % CI 0.4 to 5.3), 7 patients, cluster bootstrap",
      },
    ],
    reliability: [
      {
        quantity: "Cobb angle (°)",
        scope: "all studies",
        statistics: [
          { name: "ICC(2,1)", text: "0.98 (0.96–0.99)" },
          { name: "SEM", text: "1.1°" },
          { name: "MDC95", text: "3.1°" },
          { name: "Pearson, within an observer", text: "0.99" },
        ],
        bland_altman: {
          means: Array.from({ length: 40 }, (_, index) => 20 + index),
          differences: Array.from({ length: 40 }, (_, index) => Math.sin(index * 9.1) * 2.1 + 0.3),
          bias: 0.31,
          limits: [-2.9, 3.5],
          unit: "°",
        },
      },
    ],
    verdict: [
      "On 7 patients the estimated line predicts held-out films no better than the inflection line: 1.0 mm (95 % CI −0.2 to 2.3).",
      "The iliac line is worse than both.",
    ],
    notices: [
      { severity: "note", code: "quartiles", text: "Quartiles are interpolated linearly." },
      {
        severity: "warning",
        code: "left_out",
        text: "2 of 9 studies are left out; the table says why.",
      },
      {
        severity: "contradiction",
        code: "against_force",
        posture: "left_bending",
        level: "T8",
        text: "in 3 studies joints turn against the force.",
      },
    ],
  };
}

/** Forty studies with six readings of every film. */
export function largeCohort(): Api<"CohortView"> {
  const [pooled] = cohort().reliability;
  const scopes = ["all studies", ...manyStudies(40).map(({ id }) => id)];
  const pairs = (
    count: number,
    seed: number,
  ): Pick<Api<"BlandAltmanView">, "means" | "differences"> => ({
    means: Array.from({ length: count }, (_, i) => 20 + ((i * 7.31 + seed) % 40)),
    differences: Array.from({ length: count }, (_, i) => 3 * Math.sin(i * 9.1 + seed)),
  });
  const reliability = scopes.flatMap((scope, place) =>
    Array.from({ length: 24 }, (_, index) => ({
      ...pooled!,
      quantity: `quantity ${index + 1}`,
      scope,
      bland_altman: { ...pooled!.bland_altman!, ...pairs(place === 0 ? 3_000 : 75, index) },
    })),
  );
  const sentences = Array.from({ length: 25 }, (_, index) => `Finding ${index + 1} of the cohort.`);
  const charts = cohort().charts.map((chart) => ({
    ...chart,
    boxes: chart.boxes.map((box) => ({ ...box, outliers: pairs(2_000, 0).means })),
  }));
  const rows = manyStudies(40).map((study, index) => cohortRow(study, index));
  return { ...cohort(), rows, charts, reliability, verdict: sentences };
}

function cohortRow(study: Api<"StudySummary">, index: number): Api<"CohortRow"> {
  const cobb_deg = 30 + ((index * 37) % 23);
  const isUnknown = index === 5;
  return {
    study: study.id,
    synthetic: study.synthetic,
    status: study.status,
    excluded: index % 4 === 3 ? "the erect film lacks T4, T3 and T2" : null,
    cells: [
      { heading: "Lenke", text: "1", value: null },
      {
        heading: "main Cobb (°)",
        text: isUnknown ? "–" : cobb_deg.toFixed(1),
        value: isUnknown ? null : cobb_deg,
      },
      { heading: "flexibility (%)", text: "43", value: 43 },
      { heading: "held-out error, inflection line (mm)", text: "4.1", value: 4.1 },
    ],
  };
}

function box(label: string, five: number[], outliers: number[] = []): Api<"BoxView"> {
  return { label, count: 28, five, outliers };
}
