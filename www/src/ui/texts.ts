/** Titles and explanations of the overlap and of the stages. */
import type { Metrics, Stage } from "sim3align";
import type { Options } from "../state/options.js";
import { percent, type Unit } from "./format.js";

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

export const qualityTitles: { readonly [Q in Options["quality"]]: string } = {
  auto: "Automatic",
  fast: "Fast",
  balanced: "Balanced",
  best: "Best",
};
