/** Human-readable numbers. */

/** Rounded to significant digits, without trailing zeros. */
export const significant = (x: number, digits: number): string => String(Number(x.toPrecision(digits)));

export const percent = (share: number): string => `${Math.round(100 * share)} %`;

/** Metres as centimetres: to 0.1 mm below 10 cm, otherwise to 1 mm. */
export const centimetres = (m: number, largestM = m): string => (100 * m).toFixed(Math.abs(largestM) < 0.1 ? 2 : 1);

/** A dash for values that could not be measured. */
export const orDash = <T>(value: T | null | undefined, show: (value: T) => string): string =>
  value === null || value === undefined ? "–" : show(value);
