import { Latest } from "../api/latest";
import { simulateLoads } from "../api/loads";
import type { Api } from "../api/types";
import { lasting } from "../shell/storage.svelte";
import { loadsOf, textOf, type Load } from "./loads";

type Loads = readonly Load[];

/** Changes of the same value within this time are undone together. */
const TOGETHER_MS = 1500;
const SPOKEN_MS = 700;

/** Loads on the model of a study, kept in this browser, with the program's simulation of them. */
export class Plan {
  loads = $state.raw<Loads>([]);
  /** The edited load. */
  chosen = $state<number | null>(null);
  answer = $state.raw<Api<"LoadedModel"> | null>(null);
  problem = $state.raw<unknown>(null);
  /** The displayed shape on the path; null for the last one. */
  step = $state<number | null>(null);
  /** The film beside which the result is shown. */
  compared = $state<Api<"PostureName"> | null>(null);
  /** The last computed intervals, under these or other loads. */
  intervals = $state.raw<Api<"LoadIntervalsView"> | null>(null);
  /** Text for screen readers, updated at intervals. */
  spoken = $state("");

  /** The loads of the answer. */
  #answered = $state.raw<Loads | null>(null);
  #past = $state.raw<readonly Loads[]>([]);
  #future = $state.raw<readonly Loads[]>([]);
  #last: { word: string; at_ms: number } | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #key: string;
  readonly #latest: Latest<{ loads: Loads; line: Api<"LineKindName"> }, Api<"LoadedModel">>;

  constructor(
    private readonly study: string,
    reader: string,
    private readonly line: () => Api<"LineKindName">,
  ) {
    this.#key = `spineline.plan.${reader}.${study}`;
    this.#latest = new Latest(
      ({ loads, line }, signal) => simulateLoads(study, line, textOf(loads), signal),
      (answer, { loads }) => this.#use(answer, loads),
      {
        failed: (error) => {
          // The shape of other loads must not be shown with these.
          this.answer = null;
          this.problem = error;
        },
      },
    );
    const kept = lasting.get(this.#key);
    this.loads = (kept && loadsOf(kept)) || [];
  }

  /** Whether the answer belongs to the current loads. */
  get isCurrent(): boolean {
    return this.answer !== null && this.#answered === this.loads;
  }

  get simulation(): Api<"LoadedView"> | null {
    return this.answer?.simulation ?? null;
  }

  /** Whether the intervals belong to other loads than the current ones. */
  get areIntervalsOfOthers(): boolean {
    const { intervals } = this;
    return (
      intervals !== null && intervals.state !== "none" && intervals.file !== textOf(this.loads)
    );
  }

  /** Intervals of the rows of the table of angles, under the current loads. */
  get intervalRows(): Api<"LoadIntervalRow">[] {
    return this.isCurrent && !this.areIntervalsOfOthers ? (this.intervals?.rows ?? []) : [];
  }

  /** The displayed shape on the path. */
  get shown(): Api<"LoadStep"> | null {
    const steps = this.simulation?.steps ?? [];
    return steps[this.step ?? steps.length - 1] ?? steps.at(-1) ?? null;
  }

  /** Whether the displayed shape is the result. */
  get isResult(): boolean {
    const { simulation } = this;
    return (simulation?.converged ?? false) && this.shown === simulation?.steps.at(-1);
  }

  get canUndo(): boolean {
    return this.#past.length > 0;
  }

  get canRedo(): boolean {
    return this.#future.length > 0;
  }

  faultOf(index: number): string | null {
    if (!this.isCurrent) return null;
    return this.answer?.faults.find((fault) => fault.load === index)?.text ?? null;
  }

  /** The load as the program describes it. */
  wordsOf(index: number): string | null {
    return this.isCurrent ? (this.answer?.loads[index] ?? null) : null;
  }

  /** Adds loads as one change; the first of them is edited. */
  add(...loads: Loads): void {
    const first = this.loads.length;
    this.#change([...this.loads, ...loads]);
    this.chosen = first;
  }

  /** Replaces a load; consecutive changes with the same word are undone together. */
  edit(index: number, load: Load, word: string): void {
    const now_ms = performance.now();
    const isSame = this.#last?.word === word && now_ms - this.#last.at_ms < TOGETHER_MS;
    this.#change(
      this.loads.map((old, i) => (i === index ? load : old)),
      isSame,
    );
    this.#last = { word, at_ms: now_ms };
  }

  remove(index: number): void {
    this.#change(this.loads.filter((_, i) => i !== index));
    this.chosen = null;
  }

  clear(): void {
    this.#change([]);
    this.chosen = null;
  }

  undo(): void {
    const before = this.#past.at(-1);
    if (!before) return;
    this.#future = [...this.#future, this.loads];
    this.#past = this.#past.slice(0, -1);
    this.#put(before);
  }

  redo(): void {
    const after = this.#future.at(-1);
    if (!after) return;
    this.#past = [...this.#past, this.loads];
    this.#future = this.#future.slice(0, -1);
    this.#put(after);
  }

  /** Opens the loads of a file that the program can read; a refused file changes nothing. */
  async open(text: string, signal: AbortSignal): Promise<void> {
    const answer = await simulateLoads(this.study, this.line(), text, signal);
    const loads = loadsOf(text);
    if (!loads) throw new Error("the file has no loads");
    this.#past = [...this.#past, this.loads];
    this.#future = [];
    this.#latest.cancel();
    this.chosen = null;
    this.#set(loads);
    this.#use(answer, loads);
  }

  /** Simulates the loads again, because the line and its springs have changed. */
  again(): void {
    this.#latest.cancel();
    this.answer = null;
    this.problem = null;
    this.step = null;
    this.intervals = null;
    this.#ask();
  }

  leave(): void {
    this.#latest.cancel();
    clearTimeout(this.#timer);
  }

  #change(loads: Loads, isSame = false): void {
    if (!isSame) this.#past = [...this.#past, this.loads];
    this.#future = [];
    this.#put(loads);
  }

  #put(loads: Loads): void {
    this.#set(loads);
    this.#ask();
  }

  #set(loads: Loads): void {
    this.#last = null;
    this.loads = loads;
    if (this.chosen !== null && this.chosen >= loads.length) this.chosen = null;
    this.step = null;
    if (loads.length === 0) lasting.remove(this.#key);
    else if (!lasting.set(this.#key, textOf(loads))) lasting.refused = true;
  }

  #ask(): void {
    if (this.loads.length > 0) {
      this.#latest.send({ loads: this.loads, line: this.line() });
      return;
    }
    this.#latest.cancel();
    this.answer = null;
    this.problem = null;
    this.spoken = "No loads.";
  }

  #use(answer: Api<"LoadedModel">, loads: Loads): void {
    this.answer = answer;
    this.#answered = loads;
    this.problem = null;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      const faults = answer.faults.map(({ load, text }) => `load ${load + 1}: ${text}`);
      const end = answer.simulation?.steps.at(-1)?.text ?? "";
      this.spoken = [...faults, ...(answer.simulation?.texts.slice(0, 1) ?? []), end].join("; ");
    }, SPOKEN_MS);
  }
}
