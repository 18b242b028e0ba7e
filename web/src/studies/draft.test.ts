import { describe, expect, it } from "vitest";

import { upload } from "../../e2e/made";
import type { Api } from "../api/types";
import {
  answersOf,
  choose,
  contradictions,
  filmOf,
  idTrouble,
  openQuestions,
  postureInName,
} from "./draft";

const view = (more: Partial<Api<"UploadView">> = {}): Api<"UploadView"> => upload("u1", more);

const SPACING = {
  column_mm: 0.143,
  row_mm: 0.143,
  plane: "detector",
  text: "0.143 × 0.143 mm (detector)",
} as const;

describe("answers", () => {
  it("are open where the file lacks a value: side, posture and scale are never assumed", () => {
    const answers = answersOf(view());
    expect(answers).toMatchObject({ posture: null, patient_left: null, scale: null });
    const fields = openQuestions(answers, []).map((open) => open.field);
    expect(fields).toEqual(["posture", "patient_left", "scale"]);
  });

  it("are taken from the file where it has them", () => {
    const file = view({ posture: "erect", patient_left: "image_right", spacing: SPACING });
    const answers = answersOf(file);
    expect(openQuestions(answers, [])).toEqual([]);
    expect(contradictions(answers, file)).toEqual([]);
    expect(filmOf(answers, file)).toEqual({
      upload: "u1",
      posture: "erect",
      patient_left: "image_right",
      simultaneous: false,
      scale: { kind: "file" },
      inverted: false,
    });
  });

  it("take the posture from the file name only where it contains one and the file has none", () => {
    expect(postureInName("phantom-rod-01-left_bending.dcm")).toBe("left_bending");
    expect(postureInName("S1 Right Bending.PNG")).toBe("right_bending");
    for (const name of ["left.dcm", "uplift_erecting.png", "erect-or-neutral.png", ""])
      expect(postureInName(name)).toBeNull();
    expect(answersOf(view({ posture: "neutral" }), "erect.dcm").posture).toBe("neutral");
    expect(answersOf(view(), "erect.dcm")).toMatchObject({ posture: "erect", patient_left: null });
  });

  it("allow each posture once", () => {
    const erect = { ...answersOf(view()), posture: "erect" as const };
    const open = openQuestions({ ...erect, patient_left: "image_left", scale: "pixels" }, [erect]);
    expect(open).toHaveLength(1);
    expect(open[0]?.text).toContain("Erect");
  });

  it("need both distances and a plane for a stated scale", () => {
    const answers = {
      ...answersOf(view({ posture: "erect", patient_left: "image_left" })),
      scale: "stated" as const,
    };
    expect(openQuestions(answers, [])).toHaveLength(2);
    expect(
      openQuestions({ ...answers, column_mm: 0, row_mm: 0.1, plane: "patient" }, []),
    ).toHaveLength(1);
    const stated = { ...answers, column_mm: 0.1, row_mm: 0.2, plane: "patient" as const };
    expect(openQuestions(stated, [])).toEqual([]);
    expect(filmOf(stated, view()).scale).toEqual({
      kind: "stated",
      column_mm: 0.1,
      row_mm: 0.2,
      plane: "patient",
    });
  });

  it("that contradict the file give a contradiction", () => {
    const file = view({ posture: "erect", patient_left: "image_right", spacing: SPACING });
    const answers = {
      ...answersOf(file),
      posture: "neutral" as const,
      patient_left: "image_left" as const,
      scale: "pixels" as const,
    };
    expect(contradictions(answers, file).map((notice) => notice.code)).toEqual([
      "posture_against_file",
      "side_against_file",
      "scale_against_file",
    ]);
  });
});

describe("an identifier", () => {
  it("is checked", () => {
    expect(idTrouble("S-017_a.b", [])).toBeNull();
    expect(idTrouble("", [])).not.toBeNull();
    expect(idTrouble("Zoë", [])).toContain("accents");
    expect(idTrouble("../x", [])).not.toBeNull();
    expect(idTrouble("..", [])).toContain("Dots alone");
    expect(idTrouble("a".repeat(65), [])).toContain("65");
    expect(idTrouble("S-1", ["S-1"])).toContain("already");
  });
});

describe("a lateral film", () => {
  it("is asked which way the patient faces, and not for the plane of its scale", () => {
    const file = view({ posture: "erect", patient_left: "image_right", spacing: SPACING });
    const answers = answersOf(file);
    choose(answers, file, "lateral");
    expect(openQuestions(answers, []).map(({ text }) => text)).toEqual([
      "The file does not say which way the patient faces: choose it.",
    ]);
    answers.patient_left = "image_left";
    answers.simultaneous = true;
    Object.assign(answers, { scale: "stated", column_mm: 0.2, row_mm: 0.2 });
    expect(openQuestions(answers, [])).toEqual([]);
    const scale = { kind: "stated", column_mm: 0.2, row_mm: 0.2, plane: "unknown" };
    expect(filmOf(answers, file)).toMatchObject({ posture: "lateral", simultaneous: true, scale });
    choose(answers, file, "neutral");
    expect(answers.patient_left).toBe("image_right");
    expect(filmOf({ ...answers, scale: "file" }, file).simultaneous).toBe(false);
  });
});
