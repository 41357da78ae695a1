/** What the metrics mean, in plain language. */
import type { Metrics } from "sim3align";
import { percent, significant } from "./format.js";

interface MetricText {
  name: keyof Metrics;
  title: string;
  better: "high" | "low";
  /** What it says. */
  about: string;
  show(value: number): string;
}

const mm = (value: number) => `${significant(value, 3)} mm`;

export const metricTexts: readonly MetricText[] = [
  {
    name: "iou",
    title: "Overlap",
    better: "high",
    about:
      "How much of the mask and of the mesh's silhouette is shared by both: 100 % would be the very same shape (intersection over union).",
    show: percent,
  },
  {
    name: "boundaryF",
    title: "Outline",
    better: "high",
    about: "How well the mesh's outline follows that of the mask, within a pixel or a few (boundary F-measure).",
    show: percent,
  },
  {
    name: "depthMaeMm",
    title: "Depth off",
    better: "low",
    about: "How far, on average, the mesh's surface is before or behind what was measured, inside the mask.",
    show: mm,
  },
  {
    name: "uniChamferMm",
    title: "Points off",
    better: "low",
    about: "How far the measured points are from the mesh, on average, in any direction (one-way chamfer distance).",
    show: mm,
  },
  {
    name: "chamferMm",
    title: "Both ways",
    better: "low",
    about:
      "The same, averaged with the way back from the mesh to the measured points. The side that nobody has seen counts, so that it is never 0 (chamfer distance).",
    show: mm,
  },
  {
    name: "fitness",
    title: "Points near",
    better: "high",
    about: "The share of the measured points that are within a twentieth of the object's size of the mesh.",
    show: percent,
  },
  {
    name: "normalConsistency",
    title: "Slopes agree",
    better: "high",
    about: "How alike the mesh and the measured surface are inclined. Chance alone gives 50 % (normal consistency).",
    show: percent,
  },
  {
    name: "centerDriftPx",
    title: "Centre off",
    better: "low",
    about: "How far apart the centres of the mask and of the mesh's silhouette are, in pixels of the depth map.",
    show: (value) => `${significant(value, 2)} px`,
  },
];
