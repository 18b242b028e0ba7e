import { lasting } from "./storage.svelte";

/** All keys of the app, by page. The help lists them, and a page's actions are named by their strokes. */
export const KEYS = [
  { page: "every", strokes: ["?"], text: "list the keys of this page" },
  { page: "studies", strokes: ["/"], text: "search" },
  { page: "studies", strokes: ["ArrowUp", "ArrowDown"], text: "the previous or next study" },
  {
    page: "film",
    strokes: ["Enter", " "],
    shown: "Click, or C then Enter",
    text: "place the requested corner",
  },
  {
    page: "film",
    strokes: ["c"],
    text: "crosshair for placing landmarks: arrows move it, Shift in large steps",
  },
  {
    page: "film",
    strokes: ["t"],
    text: "two clicks per vertebra, on the middle of its walls; or four corners",
  },
  {
    page: "film",
    strokes: ["p"],
    text: "propose all vertebrae, from what is marked or from the picture; or discard the proposals",
  },
  {
    page: "film",
    strokes: ["a"],
    shown: "A, or Enter after two clicks",
    text: "accept all vertebrae that were found clearly or have both clicks; else the next one alone",
  },
  {
    page: "film",
    strokes: ["e"],
    text: "mark the pedicles of vertebrae, which give their axial rotation; or corners",
  },
  {
    page: "film",
    strokes: ["n"],
    text: "skip the optional vertebrae and go to the iliac crests",
  },
  {
    page: "film",
    strokes: ["u", "j"],
    text: "name all vertebrae, marked or proposed, one level up, one level down",
  },
  {
    page: "film",
    strokes: ["[", "]", "Tab"],
    text: "select the previous or next landmark",
  },
  {
    page: "film",
    strokes: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"],
    shown: "Arrows",
    text: "move the selected landmark 0.1 px, rotate an axis 0.1°; with Shift 1 px, 1°",
  },
  { page: "film", strokes: ["Delete"], text: "remove the vertebra of the selected landmark" },
  { page: "film", strokes: ["r"], text: "compute the axis from the corners again" },
  {
    page: "film",
    strokes: [".", ","],
    text: "the next or previous film; begins to read it, if you have not yet",
  },
  {
    page: "film",
    strokes: ["Ctrl Enter"],
    text: "finish the reading; Enter confirms and begins with the next film",
  },
  { page: "film", strokes: ["+", "=", "-", "f"], shown: "+  −  F", text: "zoom in, out, fit" },
  { page: "film", strokes: ["b"], text: "the film on the full screen, and back" },
  { page: "film", strokes: ["h"], shown: "H, or Space and drag", text: "move the film" },
  { page: "film", strokes: ["w"], shown: "W, or right button", text: "window and level" },
  { page: "film", strokes: ["v"], text: "the next preset of window and level" },
  {
    page: "film",
    strokes: ["q", "m"],
    text: "turn the picture 90° clockwise, mirror it; for display only",
  },
  {
    page: "film",
    strokes: ["d", "g"],
    text: "measure a length, an angle: click, or C then Enter; Esc begins anew. Nothing is stored",
  },
  { page: "film", strokes: ["i"], text: "invert the grey levels" },
  { page: "film", strokes: ["l"], text: "loupe" },
  {
    page: "film",
    strokes: ["1", "2", "3", "4", "5", "6", "7", "8"],
    shown: "1 – 8",
    text: "show or hide a layer",
  },
  { page: "film", strokes: ["Escape"], text: "clear the selection" },
  {
    page: "model",
    strokes: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"],
    shown: "Arrows",
    text: "rotate the spine, or move the load that has the focus; with Shift in larger steps",
  },
  { page: "model", strokes: ["+", "=", "-"], shown: "+  −", text: "zoom in, zoom out" },
  {
    page: "changes",
    strokes: ["Ctrl z", "Ctrl y", "Ctrl Shift z"],
    shown: "Ctrl Z  Ctrl Y",
    text: "undo, redo",
  },
] as const satisfies readonly Key[];

/** A row of the help. */
export interface Key {
  page: "every" | "studies" | "film" | "model" | "changes";
  strokes: readonly string[];
  /** Text of the help, if it is not the strokes; two spaces separate keys. */
  shown?: string;
  text: string;
}

/** A key with its modifiers, such as `Ctrl z`. */
type Stroke = (typeof KEYS)[number]["strokes"][number];
/** What keys do on a page; `false`: the browser's own action follows. */
export type Actions = Partial<Record<Stroke, () => unknown>>;

type Pressed = Pick<
  KeyboardEvent,
  "key" | "code" | "ctrlKey" | "metaKey" | "altKey" | "shiftKey" | "getModifierState"
>;

const OFF = "spineline.character-keys";

/** Whether keys that type a character act too: speech input and trembling hands press them unintentionally. */
class CharacterKeys {
  #on = $state(lasting.get(OFF) === null);

  get on(): boolean {
    return this.#on;
  }

  set on(on: boolean) {
    this.#on = on;
    if (on) lasting.remove(OFF);
    else lasting.set(OFF, "off");
  }
}

export const characterKeys = new CharacterKeys();

/** Characters of keys on a keyboard of the United States. */
const PLACED: Record<string, string> = {
  Minus: "-",
  Equal: "=",
  BracketLeft: "[",
  BracketRight: "]",
  Slash: "/",
  Comma: ",",
  Period: ".",
};

/**
 * The key by the character that it types, then by its place on the keyboard: letters of other scripts and the
 * shifted digits of French keyboards act too. A Latin letter counts wherever it is.
 */
function namesOf({ key, code }: Pressed): string[] {
  const isNamed = key.length > 1 && !["Dead", "Process", "Unidentified"].includes(key);
  if (isNamed) return [key];
  const typed = key.toLowerCase();
  if (/^[a-z]$/.test(typed)) return [typed];
  const placed = PLACED[code] ?? /^(?:Key|Digit)(.)$/.exec(code)?.[1]?.toLowerCase();
  return placed ? [typed, placed] : [typed];
}

/** Runs the action of a key and prevents the browser's; returns whether the key has an action. */
export function act(event: Pressed & Pick<Event, "preventDefault">, actions: Actions): boolean {
  // AltGr types a character; Windows reports it as Ctrl and Alt.
  const isTyping = event.getModifierState("AltGraph");
  const hasControl = !isTyping && (event.ctrlKey || event.metaKey);
  if (event.altKey && !isTyping) return false;
  const control = hasControl ? (event.shiftKey ? "Ctrl Shift " : "Ctrl ") : "";
  for (const name of namesOf(event)) {
    const isCharacter = !hasControl && name.length === 1 && name !== " ";
    const action = actions[`${control}${name}` as Stroke];
    if (!action || (isCharacter && !characterKeys.on)) continue;
    if (action() === false) return false;
    event.preventDefault();
    return true;
  }
  return false;
}

/** Undo and redo of anything that has them. */
export function changeKeys(changes: { undo(): void; redo(): void } | null): Actions {
  if (!changes) return {};
  const redo = (): void => changes.redo();
  return { "Ctrl z": () => changes.undo(), "Ctrl y": redo, "Ctrl Shift z": redo };
}

/** Whether a text is being typed, or a control uses its letters. */
export const isTyped = ({ target }: Event): boolean =>
  target instanceof Element && target.closest("input, textarea, select, dialog") !== null;
