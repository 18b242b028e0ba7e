import { onScale, stiffnessStops, themeColour } from "./colour";
import { hasStiffness, type Choice } from "./choice.svelte";
import type { HandLoad } from "./load.svelte";
import type { LineDrawn, Picture } from "./scene/stage";
import type { Point } from "./shapes";
import { lineToken } from "./words";

/** A picture without parts beside its main spine. */
export const BARE: Omit<Picture, "main"> = {
  layout: "one",
  other: null,
  discs: null,
  contradicted: [],
  chosenJoint: null,
  chosenLevel: null,
  lines: [],
  force: null,
  load: null,
};

/** Picture of a choice. */
export function pictureOf(choice: Choice, load: HandLoad): Picture {
  const { line, view } = choice;
  const stops = stiffnessStops();
  const common = {
    ...BARE,
    discs:
      line && hasStiffness(line)
        ? line.joints.map((joint) => onScale(stops, joint.relative))
        : null,
    chosenJoint: choice.joint,
  };
  if (choice.posture === "load") {
    const { answer } = load;
    return {
      ...common,
      layout: answer ? "overlay" : "one",
      main: answer
        ? { shape: answer.shape, tone: answer.converged ? "simulated" : "not_a_result" }
        : { shape: view.erect, tone: "erect" },
      other: answer ? { shape: view.erect, tone: "erect" } : null,
      chosenLevel: load.index,
      load: { from: load.from, tip: load.tip },
    };
  }
  const { simulated, measured, posture } = choice;
  const hasShape = simulated !== null && simulated.path.length > 0;
  const tone = hasShape && simulated.converged ? "simulated" : "not_a_result";
  const main: Picture["main"] = hasShape
    ? { shape: choice.shape, tone }
    : { shape: measured ?? view.erect, tone: measured ? "measured" : "erect" };
  return {
    ...common,
    layout: measured && hasShape ? choice.layout : "one",
    main,
    other: measured && hasShape ? { shape: measured, tone: "measured" } : null,
    contradicted:
      line?.joints.map((joint) => joint.contradicted_in.some((film) => film === posture)) ?? [],
    lines: linesOf(choice),
    force: simulated?.converged ? simulated.force_text : null,
  };
}

/** The chosen line, and the others that have a result. */
function linesOf(choice: Choice): LineDrawn[] {
  return choice.view.lines.flatMap((line) => {
    const film = line.postures.find((one) => one.posture === choice.posture);
    const isChosen = line.kind === choice.kind;
    if (!film || (!isChosen && !(choice.allLines && line.converged && film.converged))) return [];
    return {
      point: film.line_point_mm as Point,
      direction: film.line_direction as Point,
      colour: themeColour(lineToken(line.kind)),
      isChosen,
    };
  });
}
