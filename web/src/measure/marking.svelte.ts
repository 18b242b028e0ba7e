import { Refusal } from "../api/client";
import { Latest } from "../api/latest";
import {
  finishReading,
  previewReading,
  readLive,
  readReading,
  recordEvents,
} from "../api/readings";
import type { Api } from "../api/types";
import { keepingOf, keepsNothing, leftBehind, type ReadingKeeping } from "./keeping";
import {
  fresh,
  cornersOf,
  isChangeable,
  landmarkBeside,
  missingCrest,
  placeOf,
  placeWords,
  placing,
  remaining,
  round,
  stepsAfter,
  withEvents,
  wordsOf,
  wordsOfEvent,
  type Event,
  type Landmark,
  type ReadingView,
} from "./landmarks";
import { offerOf } from "./found";
import { lookedFor, type Lost, type Trouble, WENT_BACK } from "./lost";
import * as proposing from "./proposals";
import { Outbox, type SaveState } from "./outbox";
import { CRESTS, MISSING, targetOf, type Chosen } from "./target";
import { TURN_MS, turnedBy, turnedIn, type PreviewInput, type Turning } from "./turning";
import type { FilmPoint } from "./viewport";

type Preview = Api<"Preview">;
type LiveView = Api<"LiveView">;

/** An older request of a drag is cancelled for a newer one. A younger one may finish, so that a fast drag still shows results. */
const PATIENCE_MS = 250;

/** A reading in progress: recorded events, events being sent, and the current drag. */
export class Marking {
  /** The recorded reading. */
  #recorded = $state.raw() as ReadingView;
  /** Events that are not recorded yet. */
  #pending = $state.raw<Event[]>([]);
  /** The current drag. */
  #draft = $state.raw<Event[]>([]);
  #preview = $state.raw<Preview | null>(null);
  #live = $state.raw<LiveView | null>(null);
  #chosen = $state.raw<Chosen>(null);
  saving = $state.raw<SaveState>({ kind: "saved" });
  selected = $state.raw<Landmark | null>(null);
  /** How this browser marks vertebrae, where proposals are allowed. */
  #way = $state.raw() as proposing.Way;
  /** Whether all proposals are drawn. */
  proposes = $state(false);
  /** Whether the program looks for vertebrae in the picture. */
  detects = $state(false);
  detection = $state.raw(proposing.UNSEEN);
  /** Sure proposals that the picture contradicts. */
  misfits = $state.raw<string[]>([]);
  lost = $state.raw<Lost | null>(null);
  trouble = $state.raw<Trouble | null>(null);
  /** Text for screen readers. */
  said = $state("");

  /** The reading as drawn. */
  readonly reading = $derived(
    withEvents(this.#preview?.reading ?? this.#recorded, [...this.#pending, ...this.#draft]),
  );
  readonly #canPropose = $derived(proposing.canPropose(this.#recorded));
  /** The way of marking vertebrae: two clicks need proposals for the corners. */
  readonly way = $derived<proposing.Way>(
    this.#way === "walls" && !this.#canPropose ? "corners" : this.#way,
  );
  readonly live = $derived(this.#preview?.live ?? this.#live);
  readonly changeable = $derived(isChangeable(this.#recorded));
  readonly target = $derived(
    this.changeable
      ? targetOf(this.reading, this.#recorded, this.#pending, this.#chosen, this.way)
      : null,
  );
  readonly mayPropose = $derived(this.changeable && this.#canPropose);
  readonly mayMarkPedicles = $derived(this.changeable && !this.#recorded.image.is_lateral);
  readonly #open = $derived(
    this.mayPropose && (this.way === "walls" || this.#pending.length === 0)
      ? proposing.openProposals(this.reading, this.detection.proposals)
      : [],
  );
  /** Proposals that one key accepts. */
  readonly acceptable = $derived(
    proposing.acceptable(this.reading, this.#open, this.target, {
      way: this.way,
      onRequest: this.proposes,
    }),
  );
  /** Proposals to draw. */
  readonly proposals = $derived(this.proposes ? this.#open : this.acceptable);
  /** What is said of the found vertebrae before a person begins with them, or chooses one. */
  readonly offer = $derived(
    this.#chosen === null ? offerOf(this.detection.proposals, this.proposals) : null,
  );
  readonly dragging = $derived(this.#draft.length > 0);

  /** Last place of the dragged axis, and whether its angle there is known. */
  #turning: (Turning & { isAnswered: boolean }) | null = null;
  /** An axis that waits for the angle at the place of release. */
  #dropped: Promise<void> | null = null;
  #isClosed = false;
  readonly #outbox: Outbox;
  readonly #keeping: ReadingKeeping;
  readonly #tab: string;
  readonly #previews: Latest<PreviewInput, Preview>;
  readonly #lives: Latest<null, LiveView>;
  readonly #blinded: boolean;

  constructor(reading: ReadingView, tab: string) {
    this.#recorded = reading;
    this.#way = proposing.lastWay(reading);
    this.#blinded = reading.code !== null && reading.code !== undefined;
    this.#tab = tab;
    this.#keeping = reading.mine ? keepingOf(reading, tab) : keepsNothing;
    this.#previews = new Latest(
      (input, signal) => this.#askPreview(input, signal),
      (preview, input) => this.#previewed(preview, input),
      { patienceMs: PATIENCE_MS },
    );
    this.#lives = new Latest(
      (_, signal) => readLive(reading.reading, signal),
      (live) => (this.#live = live),
      { patienceMs: PATIENCE_MS },
    );
    this.#outbox = new Outbox({
      revision: reading.revision,
      send: (events, expected_revision) =>
        recordEvents(reading.reading, { expected_revision, events: [...events] }),
      keeping: this.#keeping,
      saved: (answer) => this.#use(answer.reading, answer.live ?? null),
      conflict: (_, answer, wentBack) => {
        // The refusal lists only what it lost; earlier losses stay listed.
        this.#use({ ...answer, conflicts: [...this.#recorded.conflicts, ...answer.conflicts] });
        if (wentBack) this.trouble = WENT_BACK;
        void this.#showLost();
      },
      refused: (events, error) => {
        this.trouble = { what: `Not recorded: ${events.map(wordsOfEvent).join("; ")}`, error };
        void this.reload();
      },
      changed: () => this.#outboxChanged(),
    });
    this.#outboxChanged();
    this.#refreshLive();
    if (reading.mine) void this.#showLost();
  }

  /** Number of recorded events and of events being sent. */
  get revision(): number {
    return this.#outbox.revision;
  }

  get canUndo(): boolean {
    return this.changeable && stepsAfter(this.#recorded, this.#pending).undoable > 0;
  }

  get canRedo(): boolean {
    return this.changeable && stepsAfter(this.#recorded, this.#pending).redoable > 0;
  }

  /** Places the next landmark, or the chosen one. */
  place(at: FilmPoint): Landmark | null {
    const landmark = this.target;
    if (!landmark) return null;
    this.#record([placing(this.reading, landmark, round(at))]);
    this.said = `${wordsOf(landmark)} placed`;
    return landmark;
  }

  /** Shows a landmark at a place without recording it. */
  drag(landmark: Landmark, to: FilmPoint): void {
    this.selected = landmark;
    if (landmark.kind === "axis") {
      this.#turning = { level: landmark.level, towards: to, isAnswered: false };
      this.#sendPreview({ events: this.#pending, turn: this.#turning });
      return;
    }
    this.#turning = null;
    // Proposals of the recorded reading: the drag itself must not make its proposal vanish.
    const open = proposing.openProposals(this.#recorded, this.detection.proposals);
    this.#draft = proposing.dragged(this.#recorded, this.reading, open, landmark, round(to));
    this.#sendPreview({ events: [...this.#pending, ...this.#draft] });
  }

  /** Records the dragged landmark. */
  drop(): void {
    const [draft, turning] = [this.#draft, this.#turning];
    this.#turning = null;
    this.#previews.cancel();
    if (turning && !turning.isAnswered) {
      const dropped = this.#dropTurn(turning, draft);
      this.#dropped = dropped;
      void dropped.then(() => {
        if (this.#dropped === dropped) this.#dropped = null;
      });
      return;
    }
    this.#draft = [];
    if (draft.length > 0) this.#record(draft);
  }

  /** The page closes: an axis that waits for its angle is recorded with the drawn angle. */
  keepTurn(): void {
    // A drag that has not ended is not recorded.
    if (!this.#dropped || this.#turning) return;
    const drawn = this.#draft.filter(({ kind }) => kind === "set_axis");
    if (drawn.length === 0) return;
    this.#draft = [];
    this.#record(drawn);
  }

  abandonDrag(): void {
    this.#turning = null;
    this.#previews.cancel();
    this.#draft = [];
    this.#preview = null;
  }

  /** Moves the selected landmark by pixels, or the selected axis by degrees. */
  nudge(by: FilmPoint): void {
    const landmark = this.selected;
    if (!landmark || !this.changeable) return;
    const event =
      landmark.kind === "axis" ? turnedBy(this.reading, landmark, by) : this.#moved(landmark, by);
    if (!event) return;
    this.#outbox.push([event], `nudge ${wordsOf(landmark)}`);
    this.#sendPreview({ events: this.#pending });
  }

  /** Draws the proposals of all vertebrae, detected if too little is marked; or discards what was detected. */
  async togglePropose(): Promise<void> {
    if (!this.mayPropose || this.detects) return;
    [this.proposes, this.detection] = [!this.proposes, proposing.UNSEEN];
    this.said = this.proposes ? "vertebrae proposed" : "no vertebra proposed";
    if (!this.proposes || this.#open.length > 0) return;
    // Detection takes the crests that are saved.
    if (this.#pending.length > 0) {
      [this.proposes, this.said] = [false, "saving clicks: press P again"];
      return;
    }
    this.detects = true;
    this.detection = await proposing.detected(this.#recorded.reading);
    this.detects = false;
    this.trouble = this.detection.trouble ?? this.trouble;
    if (this.detection.proposals.length === 0) return;
    // Two clicks replace a vertebra that was not found clearly.
    [this.#way, this.#chosen, this.selected] = ["walls", null, null];
  }

  /** Accepts the proposals that one key accepts and the picture does not contradict, as one change. */
  async acceptProposals(): Promise<void> {
    const [proposals, { revision }] = [this.acceptable, this];
    // A place that is being sent moves them.
    if (proposals.length === 0 || this.#pending.length > 0) return;
    const misfits = await proposing.misfits(this.#recorded.reading, proposals);
    if (this.#pending.length > 0 || this.revision !== revision) return;
    const fitting = proposals.filter(({ level }) => !misfits.includes(level));
    if (fitting.length > 0) this.#record([proposing.accepting(fitting)]);
    this.misfits = misfits;
    this.said = `${fitting.map(({ level }) => level).join(", ")} accepted as proposed`;
  }

  /** Marks by walls in place of corners, or pedicles; or back. */
  toggleWay(way: "walls" | "pedicles" = "walls"): void {
    if (!(way === "walls" ? this.mayPropose : this.mayMarkPedicles)) return;
    this.#way = this.way === way ? "corners" : way;
    if (way === "pedicles") [this.#chosen, this.selected] = [null, null];
    proposing.keepWay(this.#way);
    this.said = proposing.WAY_WORDS[this.way];
  }

  resetAxis(level: string): void {
    if (this.reading.vertebrae.find((vertebra) => vertebra.level === level)?.axis?.by_hand) {
      this.#record([{ kind: "set_axis", level, axis_deg: null }]);
    }
  }

  removeVertebra(level: string): void {
    if (!this.reading.vertebrae.some((vertebra) => vertebra.level === level)) return;
    this.selected = null;
    this.#record([{ kind: "remove_vertebra", level }]);
    this.said = `${level} removed`;
  }

  /** Names every vertebra, marked or found in the picture, one level up or down. */
  shiftLevels(up: boolean): void {
    if (!this.changeable) return;
    const proposals = proposing.shifted(this.detection.proposals, this.#recorded, up);
    this.detection = { ...this.detection, proposals };
    [this.#chosen, this.selected] = [null, null];
    if (this.reading.vertebrae.length > 0) this.#record([{ kind: "shift_levels", up }]);
    this.said = `all levels one ${up ? "up" : "down"}`;
  }

  invert(inverted: boolean): void {
    this.#record([{ kind: "invert", inverted }]);
  }

  note(text: string): void {
    this.#record([{ kind: "note", text }]);
  }

  undo(): void {
    if (!this.canUndo) return;
    this.#outbox.flush();
    this.#record([{ kind: "undo" }]);
    this.said = "undone";
  }

  redo(): void {
    if (!this.canRedo) return;
    this.#record([{ kind: "redo" }]);
    this.said = "change redone";
  }

  /** Continues with another level: at its next missing corner, or at its first corner. */
  jump(level: string): void {
    this.#chosen = level;
    const missing = MISSING[this.way](this.reading, level);
    const corner = cornersOf(this.reading)[0]!;
    this.selected = missing ? null : { kind: "corner", level, corner };
    this.said = missing ? `next: ${wordsOf(missing)}` : `${level} chosen`;
  }

  /** Continues with the iliac crests and skips the optional levels. */
  jumpToCrests(): void {
    if (this.#recorded.image.is_lateral) return;
    if (this.way === "pedicles") this.#way = "corners";
    this.#chosen = CRESTS;
    const missing = missingCrest(this.reading);
    this.selected = missing ? null : { kind: "crest", side: "left" };
    this.said = missing ? `next: ${wordsOf(missing)}` : "iliac crests selected";
  }

  /** Selects the previous or next landmark; false at the ends. */
  step(by: 1 | -1): boolean {
    const next = landmarkBeside(this.reading, this.selected, by);
    if (next) this.select(next);
    return next !== undefined;
  }

  select(landmark: Landmark | null): void {
    this.selected = landmark;
    if (landmark) this.said = `${wordsOf(landmark)}${placeWords(placeOf(this.reading, landmark))}`;
  }

  /** Whether a reported change is not known here. */
  isNews(change: Api<"Change">): boolean {
    return change.reading === this.#recorded.reading && (change.revision ?? 0) > this.revision;
  }

  async reload(): Promise<void> {
    try {
      const reading = await readReading(this.#recorded.reading);
      this.#use(reading);
      this.#outbox.rebase(reading.revision);
    } catch (error) {
      // Without a connection the shell shows a message, and the reading is loaded again afterwards.
      if (error instanceof Refusal)
        this.trouble ??= { what: "The reading could not be loaded", error };
    }
  }

  async finish(nothing_to_mark: boolean): Promise<void> {
    const { reading, revision: expected_revision } = this.#recorded;
    const done = await finishReading(reading, { expected_revision, nothing_to_mark });
    this.#use(done.reading ?? { ...this.#recorded, finished: true });
  }

  /** Records the refused changes again on the current reading. */
  applyLost(): void {
    const lost = this.lost;
    if (!lost || !this.changeable) return;
    for (const event of remaining(lost.events)) this.#record([fresh(this.reading, event)]);
    this.forgetLost();
  }

  forgetLost(): void {
    this.lost?.forget();
    this.lost = null;
    void this.#showLost();
  }

  retry(): void {
    this.#outbox.retry();
  }

  close(): void {
    this.#isClosed = true;
    this.#previews.cancel();
    this.#lives.cancel();
    // Another page of the app was opened: the dropped axis is still recorded.
    if (this.#dropped) void this.#dropped.then(() => this.#outbox.close());
    else this.#outbox.close();
  }

  #record(events: Event[]): void {
    if (!this.changeable) return;
    [this.trouble, this.misfits] = [null, []];
    this.#outbox.push(events);
  }

  /** Uses a reading with its results; requests the results if they are absent. */
  #use(reading: ReadingView, live?: LiveView | null): void {
    const isOlder = reading.revision < this.#outbox.known;
    if (isOlder || (this.#recorded.finished && !reading.finished)) return;
    this.#recorded = reading;
    if (this.#outbox.pending.length === 0 && this.#preview) {
      // The last drawing stays until the program's answer.
      this.#live = this.#preview.live ?? this.#live;
      this.#preview = null;
    }
    if (live === undefined) {
      this.#refreshLive();
      return;
    }
    // Running requests belong to an older reading.
    this.#lives.cancel();
    this.#live = live ?? this.#live;
  }

  #outboxChanged(): void {
    this.#pending = this.#outbox.pending;
    this.saving = this.#outbox.state;
  }

  #refreshLive(): void {
    if (!this.#blinded) this.#lives.send(null);
  }

  #sendPreview(input: Omit<PreviewInput, "at">): void {
    this.#previews.send({ ...input, at: performance.now() });
  }

  #askPreview({ events, turn }: Omit<PreviewInput, "at">, signal: AbortSignal): Promise<Preview> {
    const turn_axis = turn ? { level: turn.level, towards_px: [...turn.towards] } : null;
    return previewReading(this.#recorded.reading, { events: [...events], turn_axis }, signal);
  }

  #previewed(preview: Preview, { turn, at }: PreviewInput): void {
    this.#preview = preview;
    const turned = turn && turnedIn(preview, turn.level);
    if (turned) {
      this.#draft = [turned];
      if (this.#turning === turn) this.#turning = { ...this.#turning, isAnswered: true };
    }
    // Delay from the pointer's move to the drawing.
    requestAnimationFrame(() => performance.measure("drag-to-result", { start: at }));
  }

  /** Records the angle at the place of release, not the last answer. */
  async #dropTurn(turn: Turning, draft: readonly Event[]): Promise<void> {
    const what = `${turn.level} – axis not rotated`;
    try {
      const input = { events: this.#pending, turn };
      const preview = await this.#askPreview(input, AbortSignal.timeout(TURN_MS));
      const turned = turnedIn(preview, turn.level);
      if (this.#draft === draft) this.#draft = [];
      if (turned) {
        this.#preview = preview;
        this.#record([turned]);
      } else this.trouble = { what, error: "its vertebra lost its landmarks" };
    } catch (error) {
      // Another drag may have begun.
      if (this.#draft === draft && this.#turning === null) this.abandonDrag();
      this.trouble = { what, error };
    }
  }

  #moved(landmark: Landmark, by: FilmPoint): Event | null {
    const place = placeOf(this.reading, landmark);
    return place && placing(this.reading, landmark, round([place[0] + by[0], place[1] + by[1]]));
  }

  /** First the refused events of this window, then the events of other windows. */
  async #showLost(): Promise<void> {
    const events = this.#keeping.lost();
    if (events.length > 0) {
      this.lost = { events, why: "conflict", forget: () => this.#keeping.decided() };
      return;
    }
    const look = () => leftBehind(this.#recorded, this.#tab);
    const left = await lookedFor(look, () => this.#isClosed);
    if (left && this.lost === null) this.lost = { ...left, why: "left_behind" };
  }
}
