/** Human-readable numbers. */

/** Rounded to significant digits, without trailing zeros. */
export const significant = (x: number, digits: number): string => String(Number(x.toPrecision(digits)));

export const percent = (share: number): string => `${Math.round(100 * share)} %`;

/** Metres as centimetres: to 0.1 mm below 10 cm, otherwise to 1 mm. */
export const centimetres = (m: number, largestM = m): string => (100 * m).toFixed(Math.abs(largestM) < 0.1 ? 2 : 1);

/** How lengths are shown: null in metres, otherwise as multiples of this one. */
export type Unit = number | null;

/** A size in centimetres, or as a multiple. */
export const size = (m: number, unit: Unit, largestM = m): string =>
  unit === null ? `${centimetres(m, largestM)} cm` : (m / unit).toFixed(2);

/** A depth in metres, or as a multiple. */
export const depth = (m: number, unit: Unit, digits = 2): string =>
  unit === null ? `${m.toFixed(digits)} m` : (m / unit).toFixed(digits);

/** A small length in millimetres, or as a multiple. */
export const small = (m: number, unit: Unit, digits = 2): string =>
  unit === null ? `${significant(1000 * m, digits)} mm` : significant(m / unit, digits);

/** A dash for values that could not be measured. */
export const orDash = <T>(value: T | null | undefined, show: (value: T) => string): string =>
  value === null || value === undefined ? "–" : show(value);
