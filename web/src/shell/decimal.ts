/**
 * A number as people write it, with a decimal point or a decimal comma; null for other texts, including digit groups.
 */
export function parseDecimal(text: string): number | null {
  const written = /^\s*([+-]?)(\d+(?:[.,]\d*)?|[.,]\d+)\s*$/.exec(text);
  if (!written) return null;
  return Number(`${written[1] ?? ""}${(written[2] ?? "").replace(",", ".")}`);
}

/** The fault of an entered number, as text; null without one. */
export function decimalFault(
  text: string,
  [min, max]: [number, number],
  unit: string,
): string | null {
  if (text.trim() === "") return null;
  const number = parseDecimal(text);
  if (number === null) {
    return `“${text.trim()}” is not read as a number: write 25.4 or 25,4, without spaces and digit groups`;
  }
  if (number < min || number > max) return `${number} ${unit}: expected ${min} to ${max} ${unit}`;
  return null;
}
