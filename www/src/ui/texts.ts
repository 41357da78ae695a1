/** Numbers as text; titles and explanations of the overlap and of the stages. */
import type { Metrics, Stage } from "sim3align";

/** Rounded to significant digits, without trailing zeros. */
export const significant = (x: number, digits: number): string => String(Number(x.toPrecision(digits)));

/** Rounded down: 0.986 is not 99 % or more. */
export const percent = (share: number): string => `${Math.floor(100 * share + 1e-9)} %`;

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

export interface MetricText {
  name: keyof Metrics;
  title: string;
  better: "higher" | "lower";
  about: string;
  show(value: number, unit: Unit): string;
}

/** The metric that is always shown. */
export const overlapText: MetricText = {
  name: "iou",
  title: "Overlap (IoU)",
  better: "higher",
  about: "Overlap of the mask and the mesh's silhouette (intersection over union); 100 % is identical.",
  show: percent,
};

export const stageTitles: { readonly [S in Stage]: string } = {
  observe: "Reading the depth map",
  sample: "Sampling the mesh",
  normals: "Estimating normals",
  features: "Computing descriptors",
  matching: "Matching",
  ransac: "RANSAC",
  filter: "Filtering",
  icp: "ICP",
  inspect: "Inspecting the mesh",
  prepare: "Preparing",
  search: "Searching",
  refine: "Refining",
  metrics: "Computing metrics",
};
