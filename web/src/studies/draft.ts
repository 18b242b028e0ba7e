import type { Api } from "../api/types";
import { filmViews, imageSideWord, viewWord } from "../shell/words";

type ScaleKind = Api<"ScaleChoice">["kind"];

/** A scale that a person enters; null means open. */
export interface StatedSpacing {
  column_mm: number | null;
  row_mm: number | null;
  plane: Api<"SpacingPlaneName"> | null;
}

/** Answers about a film; null means open. */
export interface Answers extends StatedSpacing {
  posture: Api<"FilmViewName"> | null;
  /** On a lateral film, the side of the patient's front. */
  patient_left: Api<"ImageSideName"> | null;
  /** Whether a lateral film was exposed together with the erect one. */
  simultaneous: boolean;
  /** The distances and their plane belong to a stated one. */
  scale: ScaleKind | null;
  inverted: boolean;
}

/** The only posture, or the lateral view, whose full name is part of a file name. */
export function postureInName(name: string): Api<"FilmViewName"> | null {
  const plain = name.toLowerCase().replace(/[^a-z]+/g, "_");
  const named = filmViews.filter((posture) => `_${plain}_`.includes(`_${posture}_`));
  return named.length === 1 ? (named[0] ?? null) : null;
}

/**
 * Answers from the file. Only the posture is taken from its name, and the page asks to check it. Other values stay
 * open and are never assumed.
 */
export function answersOf(view: Api<"UploadView">, name = ""): Answers {
  return {
    posture: view.posture ?? postureInName(name),
    patient_left: view.patient_left ?? null,
    simultaneous: false,
    scale: view.spacing ? "file" : null,
    column_mm: null,
    row_mm: null,
    plane: null,
    inverted: false,
  };
}

/** Another posture or view; if left and front are exchanged by it, the side is taken from the file or asked again. */
export function choose(
  answers: Answers,
  view: Api<"UploadView">,
  posture: Api<"FilmViewName"> | null,
): void {
  const isLateral = posture === "lateral";
  if (isLateral !== (answers.posture === "lateral")) {
    const isOfFile = isLateral === (view.posture === "lateral");
    answers.patient_left = (isOfFile && view.patient_left) || null;
  }
  answers.posture = posture;
}

/** An open question and its field. */
export interface Open {
  field: "posture" | "patient_left" | "scale";
  text: string;
}

const isLength = (value: number | null): boolean =>
  value !== null && Number.isFinite(value) && value > 0;

/** Questions to be answered or corrected before the film can be used. */
export function openQuestions(
  answers: Answers,
  others: readonly Pick<Answers, "posture">[],
): Open[] {
  const open: Open[] = [];
  const { posture } = answers;
  if (posture === null) open.push({ field: "posture", text: "Which posture is this?" });
  else if (others.some((other) => other.posture === posture))
    open.push({
      field: "posture",
      text: `${viewWord(posture)} is chosen for another film too; a study has one film per posture and one lateral film.`,
    });
  if (answers.patient_left === null)
    open.push({
      field: "patient_left",
      text:
        posture === "lateral"
          ? "The file does not say which way the patient faces: choose it."
          : "The file does not contain the patient's side: choose it.",
    });
  if (answers.scale === null)
    open.push({ field: "scale", text: "The file has no spacing: enter it, or choose no scale." });
  if (answers.scale === "stated") {
    if (!isLength(answers.column_mm) || !isLength(answers.row_mm))
      open.push({ field: "scale", text: "Both distances must be above 0 mm." });
    if (answers.plane === null && posture !== "lateral")
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
      text: `The file contains ${viewWord(view.posture).toLowerCase()}; you chose ${viewWord(posture).toLowerCase()}.`,
    });
  const isOfFile = (posture === "lateral") === (view.posture === "lateral");
  if (isOfFile && view.patient_left && left && left !== view.patient_left) {
    const [what, ends] =
      posture === "lateral" ? ["front", "Front and back"] : ["left", "Left and right"];
    notices.push({
      severity: "contradiction",
      code: "side_against_file",
      text: `In the file the patient's ${what} is on the ${imageSideWord(view.patient_left)}; you chose the ${imageSideWord(left)}. ${ends} in all results depend on this answer.`,
    });
  }
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
  const simultaneous = posture === "lateral" && answers.simultaneous;
  const { upload } = view;
  return { upload, posture, patient_left, simultaneous, scale: scaleOf(answers), inverted };
}

function scaleOf(answers: Answers): Api<"ScaleChoice"> {
  if (answers.scale !== "stated") return { kind: answers.scale ?? "pixels" };
  const stated = statedScale(answers, answers.posture === "lateral");
  if (!stated) throw new Error("a film has open questions");
  return stated;
}

/** A scale that a person entered completely. */
export function statedScale(
  { column_mm, row_mm, ...rest }: StatedSpacing,
  isLateral: boolean,
): (Api<"ScaleChoice"> & { kind: "stated" }) | null {
  // The scale of a lateral film is compared with the erect film's, in any plane.
  const plane = isLateral ? "unknown" : rest.plane;
  if (column_mm === null || row_mm === null || plane === null) return null;
  return { kind: "stated", column_mm, row_mm, plane };
}

/** Why an identifier is not accepted; null if it is. */
export function idTrouble(id: string, taken: string[]): string | null {
  if (id === "") return "Enter an identifier.";
  if (!/^[A-Za-z0-9._-]+$/.test(id))
    return "Use only letters without accents, digits, dots, hyphens and underscores.";
  if (/^\.+$/.test(id)) return "Dots alone cannot be an identifier: add a letter or a digit.";
  if (id.length > 64) return `At most 64 characters; this identifier has ${id.length}.`;
  if (taken.includes(id)) return "A study with this identifier exists already.";
  return null;
}
