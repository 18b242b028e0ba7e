import { changeOptions, readOptions } from "../api/studies";
import type { Api } from "../api/types";
import { Attempt } from "../shell/attempt.svelte";

const OPTION = "inflections";

/** Inflections of a study picked by hand: two places on the erect curve, the lower one first. */
export class Picking {
  /** Options of the study, once they are loaded. */
  #view = $state.raw<Api<"OptionsView"> | null>(null);
  /** Whether a click on the film picks a place. */
  active = $state(false);
  /** Whether the lists of places are open; they stay so when the page is drawn anew. */
  listsOpen = $state(false);
  lower = $state("");
  upper = $state("");
  /** The last change. */
  readonly attempt = new Attempt();
  /** Earlier values, the last one last. */
  #before = $state.raw<string[]>([]);

  readonly mayChange = $derived(this.#view?.may_change ?? false);
  /** The value of the option; empty if the inflections are found on the erect film. */
  readonly value = $derived(this.#view?.options.find(({ name }) => name === OPTION)?.value ?? "");
  readonly canUndo = $derived(this.#before.length > 0);

  constructor(
    readonly study: string,
    /** Called after a change, because the results differ. */
    readonly onchange: () => void,
  ) {}

  async load(): Promise<void> {
    const view = await readOptions(this.study);
    // An answer older than the user's own change is ignored.
    if (this.#view && view.revision < this.#view.revision) return;
    const was = this.#view && this.value;
    this.#view = view;
    // Places that are being chosen stay, unless the option itself has changed.
    if (was !== this.value) this.#follow();
  }

  begin(): void {
    this.active = true;
    this.lower = "";
    this.upper = "";
    this.attempt.error = null;
  }

  cancel(): void {
    this.active = false;
    this.attempt.error = null;
    this.#follow();
  }

  /** A place was clicked: the lower inflection first, then the upper one, which saves both. */
  pick(site: string): void {
    if (this.lower === "" || this.upper !== "") {
      this.lower = site;
      this.upper = "";
    } else {
      this.upper = site;
      void this.set(`${this.lower},${this.upper}`);
    }
  }

  /** Saves the places; an empty value finds them on the erect film again. */
  async set(value: string): Promise<void> {
    const was = this.value;
    if (await this.#save(value)) this.#before = [...this.#before, was];
  }

  async undo(): Promise<void> {
    const was = this.#before.at(-1);
    if (was !== undefined && (await this.#save(was))) this.#before = this.#before.slice(0, -1);
  }

  async #save(value: string): Promise<boolean> {
    const view = this.#view;
    if (!view) return false;
    const options = [{ name: OPTION, value }];
    const change = { expected_revision: view.revision, reset: false, options };
    return this.attempt.run(async () => {
      this.#view = await changeOptions(this.study, change).catch(async (refusal: unknown) => {
        // Shown at once: the options are read again, as somebody else may have changed them.
        this.attempt.error = refusal;
        this.#view = await readOptions(this.study).catch(() => this.#view);
        throw refusal;
      });
      this.active = false;
      this.#follow();
      this.onchange();
    });
  }

  #follow(): void {
    const [lower = "", upper = ""] = this.value.split(",");
    this.lower = lower;
    this.upper = upper;
  }
}
