import type { Api } from "../api/types";
import { imageSideWord, postures, postureWord } from "../shell/words";

export type ScaleKind = Api<"ScaleChoice">["kind"];

/** What a person has answered about a film so far; null is not answered. */
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

/** The one posture whose whole name is part of a file's name. */
export function postureInName(name: string): Api<"PostureName"> | null {
  const plain = name.toLowerCase().replace(/[^a-z]+/g, "_");
  const named = postures.filter((posture) => `_${plain}_`.includes(`_${posture}_`));
  return named.length === 1 ? (named[0] ?? null) : null;
}

/** What the file itself answers; of its name only the posture, which is shown to be checked. Whatever they do not say stays open: it is never assumed. */
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

/** A question that still is open, and the field that it is about. */
export interface Open {
  field: "posture" | "patient_left" | "scale";
  text: string;
}

const isLength = (value: number | null): boolean =>
  value !== null && Number.isFinite(value) && value > 0;

/** What has to be answered or corrected before the film can be taken. */
export function openQuestions(answers: Answers, others: Answers[]): Open[] {
  const open: Open[] = [];
  const { posture } = answers;
  if (posture === null) open.push({ field: "posture", text: "Which posture is this?" });
  else if (others.some((other) => other.posture === posture))
    open.push({
      field: "posture",
      text: `${postureWord(posture)} is chosen for another film too; a study takes each posture once.`,
    });
  if (answers.patient_left === null)
    open.push({
      field: "patient_left",
      text: "The file does not say on which side the patient's left is.",
    });
  if (answers.scale === null)
    open.push({ field: "scale", text: "The file has no spacing: state it, or go without." });
  if (answers.scale === "stated") {
    if (!isLength(answers.column_mm) || !isLength(answers.row_mm))
      open.push({ field: "scale", text: "Both distances have to be above 0 mm." });
    if (answers.plane === null)
      open.push({ field: "scale", text: "In which plane are these millimetres?" });
  }
  return open;
}

/** Where a person says something else than the file, and what that leads to. */
export function contradictions(answers: Answers, view: Api<"UploadView">): Api<"Notice">[] {
  const notices: Api<"Notice">[] = [];
  const { posture, patient_left: left } = answers;
  if (view.posture && posture && posture !== view.posture)
    notices.push({
      severity: "warning",
      code: "posture_against_file",
      text: `The file says ${postureWord(view.posture).toLowerCase()}; you chose ${postureWord(posture).toLowerCase()}.`,
    });
  if (view.patient_left && left && left !== view.patient_left)
    notices.push({
      severity: "contradiction",
      code: "side_against_file",
      text: `The file says that the patient's left is on the ${imageSideWord(view.patient_left)}; you chose the ${imageSideWord(left)}. Left and right of every result follow this answer.`,
    });
  if (view.spacing && answers.scale !== "file")
    notices.push({
      severity: "warning",
      code: "scale_against_file",
      text: `The spacing that the file gives is not used: ${view.spacing.text}.`,
    });
  return notices;
}

/** The film as the program takes it; only once no question is open. */
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

/** Why an identifier cannot be taken; null if it can. */
export function idTrouble(id: string, taken: string[]): string | null {
  if (id === "") return "A study needs an identifier.";
  if (!/^[A-Za-z0-9._-]+$/.test(id))
    return "Only letters without accents, digits, dots, hyphens and underscores.";
  if (id.length > 64) return `At most 64 characters; this has ${id.length}.`;
  if (taken.includes(id)) return "There is a study with this identifier already.";
  return null;
}
