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
    title: "IoU",
    better: "high",
    about:
      "How much of the mask and of the mesh's silhouette is shared by both: 100 % would be the very same shape (intersection over union).",
    show: percent,
  },
  {
    name: "boundaryF",
    title: "Boundary F",
    better: "high",
    about:
      "How well the mesh's outline follows that of the mask, within a pixel or a few: the balance of precision and recall.",
    show: percent,
  },
  {
    name: "depthMaeMm",
    title: "Depth MAE",
    better: "low",
    about:
      "How far, on average, the mesh's surface is before or behind what was measured, inside the mask (mean absolute error).",
    show: mm,
  },
  {
    name: "uniChamferMm",
    title: "UniChamfer",
    better: "low",
    about:
      "How far the measured points are from the mesh, on average, in any direction (the chamfer distance, one way).",
    show: mm,
  },
  {
    name: "chamferMm",
    title: "Chamfer",
    better: "low",
    about:
      "The same, averaged with the way back from the mesh to the measured points. The side that nobody has seen counts, so that it is never 0.",
    show: mm,
  },
  {
    name: "fitness",
    title: "Fitness",
    better: "high",
    about: "The share of the measured points that are within a twentieth of the object's size of the mesh.",
    show: percent,
  },
  {
    name: "normalConsistency",
    title: "Normal consistency",
    better: "high",
    about: "How alike the mesh and the measured surface are inclined. Chance alone gives 50 %.",
    show: percent,
  },
  {
    name: "centerDriftPx",
    title: "Centre drift",
    better: "low",
    about: "How far apart the centres of the mask and of the mesh's silhouette are, in pixels of the depth map.",
    show: (value) => `${significant(value, 2)} px`,
  },
];
