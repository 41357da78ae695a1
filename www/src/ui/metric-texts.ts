/** Titles and explanations of the metrics among the details. */
import { percent, significant, small, type Unit } from "./format.js";
import type { MetricText } from "./texts.js";

const mm = (value: number, unit: Unit) => small(value / 1000, unit, 3);

export const metricTexts: readonly MetricText[] = [
  {
    name: "depthMaeMm",
    title: "Depth MAE",
    better: "lower",
    about: "Mean absolute difference between rendered and measured depth, inside the mask.",
    show: mm,
  },
  {
    name: "uniChamferMm",
    title: "UniChamfer",
    better: "lower",
    about: "Mean distance from the measured points to the mesh (one-way chamfer distance).",
    show: mm,
  },
  {
    name: "boundaryF",
    title: "Boundary F",
    better: "higher",
    about:
      "Agreement of the outlines of mask and silhouette within a few pixels: harmonic mean of precision and recall.",
    show: percent,
  },
  {
    name: "chamferMm",
    title: "Chamfer",
    better: "lower",
    about: "Chamfer distance in both directions. Includes the unseen side, so it is never 0.",
    show: mm,
  },
  {
    name: "fitness",
    title: "Fitness",
    better: "higher",
    about: "Share of the measured points closer to the mesh than 5 % of the object's size.",
    show: percent,
  },
  {
    name: "normalConsistency",
    title: "Normal consistency",
    better: "higher",
    about: "Agreement of the surface normals. Random normals give 50 %.",
    show: percent,
  },
  {
    name: "centerDriftPx",
    title: "Centre drift",
    better: "lower",
    about: "Distance between the centroids of mask and silhouette, in pixels of the depth map.",
    show: (value) => `${significant(value, 2)} px`,
  },
];
