import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";

/** Answers made up for pages that are hard to reach with the program itself. */
const POSTURES: Api<"PostureName">[] = [
  "erect",
  "left_bending",
  "right_bending",
  "neutral",
  "traction",
];

export function film(
  number: number,
  posture: Api<"PostureName">,
  more: Partial<Api<"FilmSummary">> = {},
): Api<"FilmSummary"> {
  return {
    film: number,
    posture,
    columns: 2140,
    rows: 4000,
    pixel_aspect: 1,
    plane: "patient",
    spacing_text: "0.143 mm × 0.143 mm, patient mm, by a ball (± 0.6 %)",
    patient_left: "image_right",
    inverted: false,
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
    ...more,
  };
}

export function study(id: string, more: Partial<Api<"StudySummary">> = {}): Api<"StudySummary"> {
  return {
    id,
    label: null,
    synthetic: false,
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
  ["modelled", "three lines of action fitted, all converged"],
  ["measured", "the erect film is measured; no bending film is"],
  ["marking", "12 of 15 vertebrae on the erect film"],
  ["to_mark", "no film is marked"],
  ["not_converged", "iliac line: the fit ended without converging"],
  ["refused", "T8 lies above T7 on the erect film"],
  ["blinded", "7 of 20 readings are done"],
];

/** As many studies as a group has after some years. */
export function manyStudies(count: number): Api<"StudySummary">[] {
  return Array.from({ length: count }, (_, index) => {
    const [status, status_text] = STATUSES[index % STATUSES.length] ?? STATUSES[0]!;
    const cobb_deg = 22 + ((index * 7.3) % 41);
    const isMeasured = ["modelled", "measured", "not_converged"].includes(status);
    const postures = index % 4 === 3 ? POSTURES.slice(0, 3) : POSTURES;
    return study(`S-${String(count - index).padStart(3, "0")}`, {
      label: LABELS[index % LABELS.length] ?? null,
      synthetic: index % 6 === 0,
      status,
      status_text,
      films: postures.map((posture, place) =>
        film(index * 5 + place, posture, index % 9 === 4 ? { plane: "pixels" } : {}),
      ),
      curve: isMeasured
        ? {
            lenke: "1",
            cobb_deg,
            region: "main thoracic",
            convex: "right",
            text: `Lenke 1, main thoracic ${cobb_deg.toFixed(1)}° convex right (T5–T12)`,
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
