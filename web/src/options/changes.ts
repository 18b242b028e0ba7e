import type { Api } from "../api/types";

/** Entered values, by the name of the option. */
export type Draft = Record<string, string>;

/** Files that were opened and not sent yet, by the name of the option. */
export type OpenedFiles = Record<string, { name: string; text: string }>;

export const draftOf = (view: Api<"OptionsView">): Draft =>
  Object.fromEntries(view.options.map(({ name, value }) => [name, value]));

/** The draft beside newly loaded options: entered values stay, and all others are the new ones. */
export function renewed(
  view: Api<"OptionsView">,
  before: Api<"OptionsView"> | null,
  draft: Draft,
  files: OpenedFiles = {},
): Draft {
  const entered = before ? changesOf(before, draft, files) : [];
  return {
    ...draftOf(view),
    ...Object.fromEntries(entered.map(({ name }) => [name, draft[name] ?? ""])),
  };
}

/** The options whose entered value differs from the stored one. */
export const changesOf = (
  view: Api<"OptionsView">,
  draft: Draft,
  files: OpenedFiles = {},
): Api<"OptionChange">[] =>
  view.options.flatMap(({ name, value }) => {
    const written = (draft[name] ?? value).trim();
    const file = files[name];
    if (file && written === file.name) return [{ name, value: file.text, file: file.name }];
    return written === value ? [] : [{ name, value: written }];
  });
