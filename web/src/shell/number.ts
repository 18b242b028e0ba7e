const DIGITS = new Intl.NumberFormat("en-GB", { maximumSignificantDigits: 3 });

/** The sign of a negative number in text; a number that is written as zero has none. */
function withMinus(text: string): string {
  if (!text.startsWith("-")) return text;
  const size = text.slice(1);
  return /^[0.]*$/.test(size) ? size : `−${size}`;
}

const isNumber = (value: number | null | undefined): value is number =>
  value !== null && value !== undefined && Number.isFinite(value);

/** A number with its decimal places, such as `−0.17`, as the library writes it; `–` for a missing one. */
export const fixed = (value: number | null | undefined, places: number): string =>
  isNumber(value) ? withMinus(value.toFixed(places)) : "–";

/** The unit of lengths at the spine, as the library writes it. */
export const PATIENT_MM = "mm (patient)";

/** A written number with its unit: the patient's lengths are the usual ones, and a degree sign has no space. */
export const withUnit = (number: string, unit: string): string =>
  unit === "°" ? `${number}°` : `${number} ${unit === PATIENT_MM ? "mm" : unit}`;

/** The same below a scale bar, where the plane counts. */
export const barText = (length_mm: number, unit: string): string =>
  `${withUnit(String(length_mm), unit)}${unit === PATIENT_MM ? " at the spine" : ""}`;

/** A number with three digits, such as `−12.3`; `–` for a missing one. */
export const threeDigits = (value: number | null | undefined): string =>
  isNumber(value) ? withMinus(DIGITS.format(value)) : "–";
