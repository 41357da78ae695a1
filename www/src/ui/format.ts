/** Numbers for people. */

/** With so many significant digits, and without zeros at the end. */
export const significant = (x: number, digits: number): string => String(Number(x.toPrecision(digits)));

export const percent = (share: number): string => `${Math.round(100 * share)} %`;

/** Metres as centimetres, to a tenth of a millimetre or, from 10 cm on, to a millimetre. */
export const centimetres = (m: number, largestM = m): string => (100 * m).toFixed(Math.abs(largestM) < 0.1 ? 2 : 1);

/** What cannot be measured is a dash. */
export const orDash = <T>(value: T | null | undefined, show: (value: T) => string): string =>
  value === null || value === undefined ? "–" : show(value);
