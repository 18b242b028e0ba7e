/** The film file names in a case file; null if the text is not a case file. The program parses the rest. */
export function picturesOf(text: string): string[] | null {
  let case_: unknown;
  try {
    case_ = JSON.parse(text);
  } catch {
    return null;
  }
  if (!isObject(case_) || case_.format !== "spineline-case") return null;
  const films = Array.isArray(case_.films) ? case_.films : [];
  return [...films, case_.lateral].flatMap((film: unknown) => {
    const image = isObject(film) ? film.image : null;
    return isObject(image) && typeof image.file === "string" ? [image.file] : [];
  });
}

/** The last part of a path of any operating system. */
export const baseName = (path: string): string => path.split(/[/\\]/).at(-1) ?? path;

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null;
}
