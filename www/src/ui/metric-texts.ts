/** Titles and explanations of the metrics among the details. */

import type { MetricText } from "./texts.js";
import { percent, significant, small, type Unit } from "./texts.js";

const length = (value: number, unit: Unit) => small(value, unit, 3);

export const metricTexts: readonly MetricText[] = [
  {
    name: "depthMaeM",
    title: "Depth MAE",
    better: "lower",
    about: "Mean absolute difference between rendered and measured depth, inside the mask.",
    show: length,
  },
  {
    name: "uniChamferM",
    title: "UniChamfer",
    better: "lower",
    about: "Mean distance from the measured points to the mesh (one-way chamfer distance).",
    show: length,
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
    name: "chamferM",
    title: "Chamfer",
    better: "lower",
    about: "Chamfer distance in both directions. Includes the unseen side, so it is never 0.",
    show: length,
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
