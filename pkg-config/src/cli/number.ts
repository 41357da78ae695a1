/** Numbers for people; what could not be measured is a dash. */

/** With so many digits after the point. */
export function fixed(value: number | null | undefined, digits: number): string {
  return value === null || value === undefined ? "–" : value.toFixed(digits);
}

/** With so many significant digits, and no exponent where a few zeros do. */
export function significant(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined) return "–";
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  return magnitude < -5 || magnitude > 8
    ? value.toExponential(digits - 1)
    : value.toFixed(Math.max(0, digits - 1 - magnitude));
}
