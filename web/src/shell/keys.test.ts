import { afterEach, expect, it, vi } from "vitest";

import { act, changeKeys, characterKeys, type Actions } from "./keys.svelte";

afterEach(() => (characterKeys.on = true));

/** Presses a key as a browser reports it; returns what it did. */
function press(key: string, code: string, ...held: ("ctrl" | "shift" | "alt" | "AltGraph")[]) {
  const done: string[] = [];
  const does = (name: string) => () => void done.push(name);
  const letters = [..."abcdefghilmnpqrtvw1234567[]+-"].map((name) => [name, does(name)]);
  const actions: Actions = {
    ...Object.fromEntries(letters),
    Delete: does("Delete"),
    ...changeKeys({ undo: does("undo"), redo: does("redo") }),
  };
  const event = {
    key,
    code,
    ctrlKey: held.includes("ctrl"),
    shiftKey: held.includes("shift"),
    altKey: held.includes("alt"),
    metaKey: false,
    getModifierState: (name: string) => held.includes(name as "AltGraph"),
    preventDefault: vi.fn(),
  };
  const isDone = act(event, actions);
  expect(event.preventDefault).toHaveBeenCalledTimes(isDone ? 1 : 0);
  return done.join();
}

it("letters act on keyboards of other scripts by their place", () => {
  const layouts = {
    Russian: [
      ["т", "KeyN"],
      ["Ф", "KeyA"],
      ["х", "BracketLeft"],
      ["ъ", "BracketRight"],
    ],
    Greek: [
      ["ν", "KeyN"],
      ["Α", "KeyA"],
      ["[", "BracketLeft"],
      ["]", "BracketRight"],
    ],
    Hebrew: [
      ["מ", "KeyN"],
      ["ש", "KeyA"],
      ["]", "BracketLeft"],
      ["[", "BracketRight"],
    ],
  };
  for (const [layout, [n, a]] of Object.entries(layouts)) {
    expect([layout, press(...(n as [string, string]))]).toEqual([layout, "n"]);
    expect([layout, press(...(a as [string, string]))]).toEqual([layout, "a"]);
  }
  expect(press("х", "BracketLeft")).toBe("[");
  // Some of its letters are signs.
  expect(press("/", "KeyQ")).toBe("q");
  expect(press("'", "KeyW")).toBe("w");
});

it("undo and redo act on all keyboards", () => {
  for (const z of ["я", "Я", "ζ", "ז"]) expect(press(z, "KeyZ", "ctrl")).toBe("undo");
  expect(press("я", "KeyZ", "ctrl", "shift")).toBe("redo");
  expect(press("н", "KeyY", "ctrl")).toBe("redo");
});

it("a Latin letter acts wherever it is", () => {
  // German: Z and Y are exchanged. French: Q is where A is.
  expect(press("z", "KeyY", "ctrl")).toBe("undo");
  expect(press("y", "KeyZ", "ctrl")).toBe("redo");
  expect(press("q", "KeyA")).toBe("q");
  expect(press("A", "KeyQ", "shift")).toBe("a");
});

it("signs and digits act where a keyboard has them", () => {
  expect(press("&", "Digit1")).toBe("1");
  expect(press("+", "BracketRight")).toBe("+");
  expect(press("-", "Digit6")).toBe("-");
  expect(press("[", "Digit8", "ctrl", "alt", "AltGraph")).toBe("[");
});

it("keys of the browser and of the system stay theirs", () => {
  expect(press("f", "KeyF", "ctrl")).toBe("");
  expect(press("f", "KeyF", "alt")).toBe("");
  expect(press("Dead", "Backquote")).toBe("");
});

it("switched off, only keys that type no character act", () => {
  characterKeys.on = false;
  expect(press("n", "KeyN")).toBe("");
  expect(press("т", "KeyN")).toBe("");
  expect(press("1", "Digit1")).toBe("");
  expect(press("Delete", "Delete")).toBe("Delete");
  expect(press("z", "KeyZ", "ctrl")).toBe("undo");
});
