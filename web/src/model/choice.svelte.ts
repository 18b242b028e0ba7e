import type { Api } from "../api/types";
import { isPitchMeasured } from "./assumed";
import { along, type Shape } from "./shapes";

type LineKindName = Api<"LineKindName">;
type PostureName = Api<"PostureName">;

/** Layout of simulated and measured spines. */
export type Layout = "overlay" | "beside" | "one";

/** Whether the fit gave stiffness; single films may lack a result. */
export function hasStiffness(line: Api<"LineModelView">): boolean {
  return line.multipliers.every((one) => one.identified !== "not_converged");
}

/** Selected part of the model. */
export class Choice {
  kind = $state<LineKindName>("inflection_line");
  /** A film, or a load by hand. */
  posture = $state<PostureName | "load">("erect");
  layout = $state<Layout>("overlay");
  /** Part of the force, 0 to 1. */
  part = $state(1);
  /** Selected joint, counted from L4/L3. */
  joint = $state<number | null>(null);
  allLines = $state(true);
  /** Whether flat views are chosen. */
  flat = $state(false);
  /** Why the 3D view is missing, if it is. */
  withoutGl = $state<string | null>(null);

  constructor(readonly view: Api<"ModelView">) {
    this.flat = !isPitchMeasured(view);
    const automatic = view.lines.find((one) => one.converged && one.kind === view.automatic);
    const line = automatic ?? view.lines.find((one) => one.converged) ?? view.lines[0];
    if (line) this.kind = line.kind;
    const film = line?.postures.find((one) => one.fitted) ?? line?.postures[0];
    if (film) this.posture = film.posture;
  }

  /** Whether the picture is flat: by choice, or because the 3D view is missing. */
  get isFlat(): boolean {
    return this.flat || this.withoutGl !== null;
  }

  get line(): Api<"LineModelView"> | null {
    return this.view.lines.find((one) => one.kind === this.kind) ?? null;
  }

  get simulated(): Api<"SimulatedPosture"> | null {
    return this.line?.postures.find((one) => one.posture === this.posture) ?? null;
  }

  get measured(): Shape | null {
    return this.view.measured.find((one) => one.posture === this.posture)?.shape ?? null;
  }

  /** The simulated spine under the chosen part of the force. */
  get shape(): Shape {
    const path = this.simulated?.path ?? [];
    return path.length > 0 ? along(path, this.part) : this.view.erect;
  }

  /** Films simulated with the line, else the measured films, which were neither fitted nor held out. */
  get films(): { posture: PostureName; fitted: boolean | null; converged: boolean }[] {
    if (this.line) return this.line.postures;
    return this.view.measured.map(({ posture }) => ({ posture, fitted: null, converged: true }));
  }

  choose(posture: PostureName | "load"): void {
    this.posture = posture;
    this.part = 1;
  }
}
