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
  marksOf,
  missingCorner,
  missingCrest,
  placeOf,
  placing,
  remaining,
  sameMark,
  stepsAfter,
  withEvents,
  wordsOf,
  wordsOfEvent,
  type Event,
  type Mark,
  type ReadingView,
} from "./marks";
import { Outbox, type SaveState } from "./outbox";
import { CRESTS, targetOf, type Chosen } from "./target";
import { filmPoint, type FilmPoint } from "./viewport";

type Preview = Api<"Preview">;
type LiveView = Api<"LiveView">;

/** Events that were not recorded, and why. */
export interface Lost {
  readonly events: readonly Event[];
  readonly why: "conflict" | "left_behind";
  /** When windows that left events behind did so. */
  readonly since_ms?: number;
  /** Whether such a window may still be open. */
  readonly mayBeOpen?: boolean;
  readonly forget: () => void;
}

/** What went wrong with a change, and why. */
export interface Trouble {
  readonly what: string;
  readonly error: unknown;
}

/** An axis that follows a hand: the program turns it, so that its angle comes with an answer. */
interface Turning {
  readonly level: string;
  readonly towards: FilmPoint;
}

interface PreviewWish {
  readonly events: readonly Event[];
  readonly turn?: Turning;
  /** When the hand moved. */
  readonly at: number;
}

/** A request of a drag older than this gives way to a newer one; a younger one is let finish, or a fast hand would see nothing. */
const PATIENCE_MS = 250;
/** How often, and how far apart, it is asked what just closed windows left. */
const AGAIN_TIMES = 5;
const AGAIN_MS = 800;
/** How long a dropped axis waits for its angle. */
const TURN_MS = 5_000;

/** One reading while it is being marked: what is recorded, what is on its way, and what a hand is doing right now. */
export class Marking {
  /** As the program has it. */
  #recorded = $state.raw() as ReadingView;
  /** Not recorded yet. */
  #pending = $state.raw<Event[]>([]);
  /** While something is dragged. */
  #draft = $state.raw<Event[]>([]);
  #preview = $state.raw<Preview | null>(null);
  #live = $state.raw<LiveView | null>(null);
  #chosen = $state.raw<Chosen>(null);
  saving = $state.raw<SaveState>({ kind: "saved" });
  selected = $state.raw<Mark | null>(null);
  lost = $state.raw<Lost | null>(null);
  /** What was not recorded, or not read. */
  trouble = $state.raw<Trouble | null>(null);
  /** To be read aloud. */
  said = $state("");

  /** As it is to be drawn. */
  readonly reading = $derived(
    withEvents(this.#preview?.reading ?? this.#recorded, [...this.#pending, ...this.#draft]),
  );
  readonly live = $derived(this.#preview?.live ?? this.#live);
  readonly changeable = $derived(this.#recorded.mine && !this.#recorded.finished);
  readonly target = $derived(
    this.changeable ? targetOf(this.reading, this.#recorded, this.#pending, this.#chosen) : null,
  );
  readonly dragging = $derived(this.#draft.length > 0);

  /** Where the axis that is dragged was pulled to last, and whether its angle there is known. */
  #turning: (Turning & { isAnswered: boolean }) | null = null;
  /** An axis that waits for the angle where the hand let go. */
  #dropped: Promise<void> | null = null;
  #isClosed = false;
  readonly #outbox: Outbox;
  readonly #keeping: ReadingKeeping;
  readonly #tab: string;
  readonly #previews: Latest<PreviewWish, Preview>;
  readonly #lives: Latest<null, LiveView>;
  readonly #blinded: boolean;

  constructor(reading: ReadingView, tab: string) {
    this.#recorded = reading;
    this.#blinded = reading.code !== null && reading.code !== undefined;
    this.#tab = tab;
    this.#keeping = reading.mine ? keepingOf(reading, tab) : keepsNothing;
    this.#previews = new Latest(
      (wish, signal) => this.#askPreview(wish, signal),
      (preview, wish) => this.#previewed(preview, wish),
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
      conflict: (_, answer) => {
        // The refusal brings what it lost alone; what was lost before stays listed.
        this.#use({ ...answer, conflicts: [...this.#recorded.conflicts, ...answer.conflicts] });
        void this.#showLost();
      },
      refused: (events, error) => {
        this.trouble = { what: `Not recorded: ${events.map(wordsOfEvent).join("; ")}`, error };
        void this.reload();
      },
      changed: () => this.#outboxChanged(),
    });
    this.#pending = this.#outbox.pending;
    this.saving = this.#outbox.state;
    this.#refreshLive();
    if (reading.mine) void this.#showLost();
  }

  /** Number of events that the program has, and those on their way. */
  get revision(): number {
    return this.#outbox.revision;
  }

  get canUndo(): boolean {
    return this.changeable && stepsAfter(this.#recorded, this.#pending).undoable > 0;
  }

  get canRedo(): boolean {
    return this.changeable && stepsAfter(this.#recorded, this.#pending).redoable > 0;
  }

  /** Puts the next mark, or the one that was chosen, at a place. */
  place(at: FilmPoint): Mark | null {
    const mark = this.target;
    if (!mark) return null;
    this.#record([placing(this.reading, mark, round(at))]);
    this.said = `${wordsOf(mark)} placed`;
    return mark;
  }

  /** Shows a mark at a place without recording it. */
  drag(mark: Mark, to: FilmPoint): void {
    this.selected = mark;
    if (mark.kind === "axis") {
      this.#turning = { level: mark.level, towards: to, isAnswered: false };
      this.#wish({ events: this.#pending, turn: this.#turning });
      return;
    }
    this.#turning = null;
    this.#draft = this.#placingAt(mark, round(to));
    this.#wish({ events: [...this.#pending, ...this.#draft] });
  }

  /** Records what was dragged. */
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
    if (draft.length === 0) return;
    this.#record(draft);
  }

  /** The page goes: an axis that waits for its angle takes the one that is drawn. */
  keepTurn(): void {
    // A drag that is still on, of an axis or of another mark, is nobody's decision yet.
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

  /** Moves the chosen mark a little: pixels for places, degrees for axes. */
  nudge(by: FilmPoint): void {
    const mark = this.selected;
    if (!mark || !this.changeable) return;
    const event = mark.kind === "axis" ? this.#turned(mark, by) : this.#moved(mark, by);
    if (!event) return;
    this.#outbox.push([event], `nudge ${wordsOf(mark)}`);
    this.#wish({ events: this.#pending });
  }

  acceptProposal(): void {
    const proposal = this.#proposal();
    if (!proposal || !this.changeable) return;
    this.#record(
      proposal.corners.map(({ corner, px }) =>
        placing(this.reading, { kind: "corner", level: proposal.level, corner }, filmPoint(px)),
      ),
    );
    this.said = `${proposal.level} accepted as proposed`;
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
    this.said = "done again";
  }

  /** Goes on with another level: to its next missing corner, or to its first one. */
  jump(level: string): void {
    this.#chosen = level;
    const missing = missingCorner(this.reading, level);
    this.selected = missing ? null : { kind: "corner", level, corner: "superior_left" };
    this.said = missing ? `next: ${wordsOf(missing)}` : `${level} chosen`;
  }

  /** Goes on with the iliac crests, past the levels that are optional. */
  jumpToCrests(): void {
    this.#chosen = CRESTS;
    const missing = missingCrest(this.reading);
    this.selected = missing ? null : { kind: "crest", side: "left" };
    this.said = missing ? `next: ${wordsOf(missing)}` : "iliac crests chosen";
  }

  /** Chooses the mark before or after; false at the ends. */
  step(by: 1 | -1): boolean {
    const marks = marksOf(this.reading);
    const now = marks.findIndex((mark) => sameMark(mark, this.selected));
    const next = marks[now < 0 ? (by > 0 ? 0 : marks.length - 1) : now + by];
    if (!next) return false;
    this.select(next);
    return true;
  }

  select(mark: Mark | null): void {
    this.selected = mark;
    if (!mark) return;
    const place = placeOf(this.reading, mark);
    const at = place ? `, column ${place[0].toFixed(1)} px, row ${place[1].toFixed(1)} px` : "";
    this.said = `${wordsOf(mark)}${at}`;
  }

  /** Whether a change that was told of is news here. */
  isNews(change: Api<"Change">): boolean {
    return change.reading === this.#recorded.reading && (change.revision ?? 0) > this.revision;
  }

  async reload(): Promise<void> {
    try {
      const reading = await readReading(this.#recorded.reading);
      this.#use(reading);
      this.#outbox.rebase(reading.revision);
    } catch (error) {
      // Where the program is away, the shell says so, and the reading is read again after it.
      if (error instanceof Refusal)
        this.trouble ??= { what: "The reading could not be read", error };
    }
  }

  async finish(): Promise<void> {
    const { reading, revision } = this.#recorded;
    this.#use(await finishReading(reading, { expected_revision: revision }));
  }

  /** Records again what was lost, upon the reading as it stands. */
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
    // Another page of the app: what was dropped is recorded all the same.
    if (this.#dropped) void this.#dropped.then(() => this.#outbox.close());
    else this.#outbox.close();
  }

  #record(events: Event[]): void {
    if (!this.changeable) return;
    this.trouble = null;
    this.#outbox.push(events);
  }

  /** Takes a reading with what follows from it; without that, it is asked for. */
  #use(reading: ReadingView, live?: LiveView | null): void {
    // An answer that was overtaken by a newer one.
    const isOlder = reading.revision < this.#outbox.known;
    if (isOlder || (this.#recorded.finished && !reading.finished)) return;
    this.#recorded = reading;
    if (this.#outbox.pending.length === 0 && this.#preview) {
      // What was drawn last stays until the program's answer replaces it.
      this.#live = this.#preview.live ?? this.#live;
      this.#preview = null;
    }
    if (live === undefined) {
      this.#refreshLive();
      return;
    }
    // What is under way is about an older reading.
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

  #wish(wish: Omit<PreviewWish, "at">): void {
    this.#previews.send({ ...wish, at: performance.now() });
  }

  #askPreview({ events, turn }: Omit<PreviewWish, "at">, signal: AbortSignal): Promise<Preview> {
    const turn_axis = turn ? { level: turn.level, towards_px: [...turn.towards] } : null;
    return previewReading(this.#recorded.reading, { events: [...events], turn_axis }, signal);
  }

  #previewed(preview: Preview, { turn, at }: PreviewWish): void {
    this.#preview = preview;
    const turned = turn && turnedIn(preview, turn.level);
    if (turned) {
      this.#draft = [turned];
      if (this.#turning === turn) this.#turning = { ...this.#turning, isAnswered: true };
    }
    // What people feel: from the hand's move to what is drawn from it.
    requestAnimationFrame(() => performance.measure("drag-to-result", { start: at }));
  }

  /** Records the angle at the place where the hand let go, not the one that was answered last. */
  async #dropTurn(turn: Turning, draft: readonly Event[]): Promise<void> {
    const what = `${turn.level} – axis not turned`;
    try {
      const wish = { events: this.#pending, turn };
      const preview = await this.#askPreview(wish, AbortSignal.timeout(TURN_MS));
      const turned = turnedIn(preview, turn.level);
      if (this.#draft === draft) this.#draft = [];
      if (turned) {
        this.#preview = preview;
        this.#record([turned]);
      } else this.trouble = { what, error: "its vertebra is no longer marked" };
    } catch (error) {
      // Another drag may have begun meanwhile.
      if (this.#draft === draft && this.#turning === null) this.abandonDrag();
      this.trouble = { what, error };
    }
  }

  #moved(mark: Mark, by: FilmPoint): Event | null {
    const place = placeOf(this.reading, mark);
    return place && placing(this.reading, mark, round([place[0] + by[0], place[1] + by[1]]));
  }

  #turned(mark: Mark & { kind: "axis" }, by: FilmPoint): Event | null {
    const axis = this.reading.vertebrae.find(({ level }) => level === mark.level)?.axis;
    if (!axis) return null;
    // To the right and up turn clockwise as seen; a whole step lands on the grid of 0.1°.
    const tenths = Math.round((axis.axis_deg + by[0] - by[1]) * 10);
    return { kind: "set_axis", level: mark.level, axis_deg: tenths / 10 };
  }

  /** A dragged corner of a proposal brings the other three along: now somebody has touched them. */
  #placingAt(mark: Mark, at: FilmPoint): Event[] {
    const moved = placing(this.reading, mark, at);
    const proposal = this.#proposal();
    const isProposed =
      mark.kind === "corner" &&
      proposal?.level === mark.level &&
      !this.#recorded.vertebrae.some(({ level }) => level === mark.level);
    if (!isProposed || mark.kind !== "corner") return [moved];
    return proposal.corners.map(({ corner, px }) => {
      const place = corner === mark.corner ? at : filmPoint(px);
      const [column_px, row_px] = place;
      return { kind: "place_corner", level: mark.level, corner, column_px, row_px };
    });
  }

  #proposal(): Api<"Proposal"> | null {
    return this.#pending.length === 0 ? (this.#recorded.proposal ?? null) : null;
  }

  /** First what this window has lost, then what others left behind. */
  async #showLost(): Promise<void> {
    const events = this.#keeping.lost();
    if (events.length > 0) {
      this.lost = { events, why: "conflict", forget: () => this.#keeping.decided() };
      return;
    }
    let left = await leftBehind(this.#recorded, this.#tab);
    // A window that closes keeps its name for a moment.
    for (let i = 0; !left && i < AGAIN_TIMES && !this.#isClosed; i += 1) {
      await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      left = await leftBehind(this.#recorded, this.#tab);
    }
    if (left && this.lost === null) this.lost = { ...left, why: "left_behind" };
  }
}

function turnedIn(preview: Preview, level: string): Event | null {
  const axis = preview.reading.vertebrae.find((vertebra) => vertebra.level === level)?.axis;
  return axis ? { kind: "set_axis", level, axis_deg: axis.axis_deg } : null;
}

/** Places are kept to a thousandth of a pixel. */
function round([column, row]: FilmPoint): FilmPoint {
  return [Math.round(column * 1_000) / 1_000, Math.round(row * 1_000) / 1_000];
}

/** The same place again, on a reading that has changed: whether a corner is placed or moved depends on it. */
function fresh(reading: ReadingView, event: Event): Event {
  if (event.kind !== "place_corner" && event.kind !== "move_corner") return event;
  const mark: Mark = { kind: "corner", level: event.level, corner: event.corner };
  return placing(reading, mark, [event.column_px, event.row_px]);
}
