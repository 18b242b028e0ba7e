import type { Api } from "../api/types";

type Words<Name extends string> = Record<Name, string>;

const POSTURES: Words<Api<"PostureName">> = {
  erect: "Erect",
  left_bending: "Left bending",
  right_bending: "Right bending",
  neutral: "Neutral",
  traction: "Traction",
};

/** The lateral film comes last. */
const VIEWS: Words<Api<"FilmViewName">> = { ...POSTURES, lateral: "Lateral" };

const SHORT_VIEWS: typeof VIEWS = { ...VIEWS, left_bending: "Left", right_bending: "Right" };

const SIDES: Words<Api<"SideName">> = { left: "patient's left", right: "patient's right" };

const IMAGE_SIDES: Words<Api<"ImageSideName">> = {
  image_left: "left side of the picture",
  image_right: "right side of the picture",
};

const PLANES: Words<Api<"SpacingPlaneName">> = {
  patient: "millimetres in the plane of the spine",
  detector: "millimetres in the plane of the detector: larger than the patient",
  unknown: "millimetres of an unknown plane",
  pixels: "no scale: angles only",
};

const ROLES: Words<Api<"RoleName">> = { reader: "Reader", editor: "Editor", admin: "Admin" };

const STATUSES: Words<Api<"StudyStatus">> = {
  to_mark: "Not marked yet",
  marking: "Being marked",
  measured: "Measured",
  modelled: "Modelled",
  unsupported: "Modelled, not supported",
  not_converged: "Not converged",
  refused: "Contradicted",
  blinded: "Blinded",
};

const SEVERITIES: Words<Api<"Severity">> = {
  note: "Note",
  warning: "Warning",
  contradiction: "Contradiction",
  error: "Error",
};

const LINES: Words<Api<"LineKindName">> = {
  inflection_line: "Inflection line",
  iliac_line: "Iliac line",
  estimated_line: "Estimated line",
  given_line: "Given line",
};

/** Postures in the usual order. */
export const postures = Object.keys(POSTURES) as Api<"PostureName">[];

/** The views of films, in the usual order. */
export const filmViews = Object.keys(VIEWS) as Api<"FilmViewName">[];

/** Films in the usual order of their views. */
export const inFilmOrder = <F extends { posture: Api<"FilmViewName"> }>(films: readonly F[]): F[] =>
  films.toSorted((a, b) => filmViews.indexOf(a.posture) - filmViews.indexOf(b.posture));

/** The posture on a frontal film. */
export const postureOf = (view: Api<"FilmViewName">): Api<"PostureName"> | null =>
  view === "lateral" ? null : view;

/** Lines of action in the order in which they are compared. */
export const lineNames = Object.keys(LINES) as Api<"LineKindName">[];

/** All statuses in the order of the work on a study. */
export const statuses = Object.keys(STATUSES) as Api<"StudyStatus">[];

export const viewWord = (view: Api<"FilmViewName">): string => VIEWS[view];

/** Short form, below a thumbnail. */
export const shortViewWord = (view: Api<"FilmViewName">): string => SHORT_VIEWS[view];

export const sideWord = (side: Api<"SideName">): string => SIDES[side];

export const imageSideWord = (side: Api<"ImageSideName">): string => IMAGE_SIDES[side];

export const planeWord = (plane: Api<"SpacingPlaneName">): string => PLANES[plane];

export const roleWord = (role: Api<"RoleName">): string => ROLES[role];

export const statusWord = (status: Api<"StudyStatus">): string => STATUSES[status];

export const severityWord = (severity: Api<"Severity">): string => SEVERITIES[severity];

export const reportNoticeWord = (kind: Api<"ReportNoticeKind">): string =>
  kind === "banner" ? "Read first" : severityWord(kind);

export const lineWord = (line: Api<"LineKindName">): string => LINES[line];

/** Such as `1 film` and `3 films`. */
export const counted = (count: number, one: string, many = `${one}s`): string =>
  `${count} ${count === 1 ? one : many}`;

const DAY = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium" });
const DAY_AND_TIME = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium", timeStyle: "short" });

/** A moment in this machine's time zone. */
export const momentText = (at_ms: number): string => DAY_AND_TIME.format(at_ms);

/** The day of a moment in this machine's time zone. */
export const dayText = (at_ms: number): string => DAY.format(at_ms);
