/** Titles and explanations of metrics and stages. */
import type { Metrics, Stage } from "sim3align";
import type { Options } from "../state/options.js";
import { percent, significant, small, type Unit } from "./format.js";

export interface MetricText {
  name: keyof Metrics;
  title: string;
  better: "higher" | "lower";
  about: string;
  show(value: number, unit: Unit): string;
}

const mm = (value: number, unit: Unit) => small(value / 1000, unit, 3);

export const metricTexts: readonly MetricText[] = [
  {
    name: "iou",
    title: "Overlap (IoU)",
    better: "higher",
    about: "Overlap of the mask and the mesh's silhouette (intersection over union); 100 % is identical.",
    show: percent,
  },
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

export const qualityTitles: { readonly [Q in Options["quality"]]: string } = {
  auto: "Automatic",
  fast: "Fast",
  balanced: "Balanced",
  best: "Best",
};
