import type { Api } from "../api/types";
import { imageSideWord, postures, postureWord } from "../shell/words";

export type ScaleKind = Api<"ScaleChoice">["kind"];

/** Answers about a film; null is not answered. */
export interface Answers {
  posture: Api<"PostureName"> | null;
  patient_left: Api<"ImageSideName"> | null;
  scale: ScaleKind | null;
  /** Only with a stated scale. */
  column_mm: number | null;
  row_mm: number | null;
  plane: Api<"PlaneName"> | null;
  inverted: boolean;
}

/** The only posture whose full name is part of a file name. */
export function postureInName(name: string): Api<"PostureName"> | null {
  const plain = name.toLowerCase().replace(/[^a-z]+/g, "_");
  const named = postures.filter((posture) => `_${plain}_`.includes(`_${posture}_`));
  return named.length === 1 ? (named[0] ?? null) : null;
}

/** Answers from the file. From its name only the posture is taken, and the page asks to check it. Other values stay open: none is assumed. */
export function answersOf(view: Api<"UploadView">, name = ""): Answers {
  return {
    posture: view.posture ?? postureInName(name),
    patient_left: view.patient_left ?? null,
    scale: view.spacing ? "file" : null,
    column_mm: null,
    row_mm: null,
    plane: null,
    inverted: false,
  };
}

/** An open question and its field. */
export interface Open {
  field: "posture" | "patient_left" | "scale";
  text: string;
}

const isLength = (value: number | null): boolean =>
  value !== null && Number.isFinite(value) && value > 0;

/** Questions to be answered or corrected before the film can be used. */
export function openQuestions(answers: Answers, others: Answers[]): Open[] {
  const open: Open[] = [];
  const { posture } = answers;
  if (posture === null) open.push({ field: "posture", text: "Which posture is this?" });
  else if (others.some((other) => other.posture === posture))
    open.push({
      field: "posture",
      text: `${postureWord(posture)} is chosen for another film too; a study has one film per posture.`,
    });
  if (answers.patient_left === null)
    open.push({
      field: "patient_left",
      text: "The file does not contain the patient's side: choose it.",
    });
  if (answers.scale === null)
    open.push({ field: "scale", text: "The file has no spacing: enter it, or choose no scale." });
  if (answers.scale === "stated") {
    if (!isLength(answers.column_mm) || !isLength(answers.row_mm))
      open.push({ field: "scale", text: "Both distances must be above 0 mm." });
    if (answers.plane === null)
      open.push({ field: "scale", text: "Choose the plane of these millimetres." });
  }
  return open;
}

/** Answers that contradict the file, with their consequences. */
export function contradictions(answers: Answers, view: Api<"UploadView">): Api<"Notice">[] {
  const notices: Api<"Notice">[] = [];
  const { posture, patient_left: left } = answers;
  if (view.posture && posture && posture !== view.posture)
    notices.push({
      severity: "warning",
      code: "posture_against_file",
      text: `The file contains ${postureWord(view.posture).toLowerCase()}; you chose ${postureWord(posture).toLowerCase()}.`,
    });
  if (view.patient_left && left && left !== view.patient_left)
    notices.push({
      severity: "contradiction",
      code: "side_against_file",
      text: `In the file the patient's left is on the ${imageSideWord(view.patient_left)}; you chose the ${imageSideWord(left)}. Left and right in all results depend on this answer.`,
    });
  if (view.spacing && answers.scale !== "file")
    notices.push({
      severity: "warning",
      code: "scale_against_file",
      text: `The spacing of the file is not used: ${view.spacing.text}.`,
    });
  return notices;
}

/** The film as the interface expects it; only when no question is open. */
export function filmOf(answers: Answers, view: Api<"UploadView">): Api<"NewFilm"> {
  const { posture, patient_left, inverted } = answers;
  if (posture === null || patient_left === null) throw new Error("a film has open questions");
  return { upload: view.upload, posture, patient_left, scale: scaleOf(answers), inverted };
}

function scaleOf({ scale, column_mm, row_mm, plane }: Answers): Api<"ScaleChoice"> {
  if (scale !== "stated") return { kind: scale ?? "pixels" };
  if (column_mm === null || row_mm === null || plane === null)
    throw new Error("a film has open questions");
  return { kind: "stated", column_mm, row_mm, plane };
}

/** Why an identifier is not accepted; null if it is. */
export function idTrouble(id: string, taken: string[]): string | null {
  if (id === "") return "Enter an identifier.";
  if (!/^[A-Za-z0-9._-]+$/.test(id))
    return "Use only letters without accents, digits, dots, hyphens and underscores.";
  if (id.length > 64) return `At most 64 characters; this identifier has ${id.length}.`;
  if (taken.includes(id)) return "A study with this identifier exists already.";
  return null;
}
