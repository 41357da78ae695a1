/** Formats numbers for tables; a missing value is a dash. */

/** Formats a number with a fixed number of decimals. */
export function fixed(value: number | null | undefined, digits: number): string {
  return value === null || value === undefined ? "–" : value.toFixed(digits);
}

/** Formats a number with the given significant digits, without an exponent if a few zeros suffice. */
export function significant(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined) return "–";
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return magnitude < -5 || magnitude > 8
    ? value.toExponential(digits - 1)
    : value.toFixed(Math.max(0, digits - 1 - magnitude));
}
