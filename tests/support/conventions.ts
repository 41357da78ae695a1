/**
 * Values that other programs computed: pycocotools 2.0.11, label-studio-converter 0.0.59 and cvat-sdk 2.80.0 encoded the
 * masks; NumPy computed the poses from each convention's own formula.
 */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { generatorFrames } from "sim3align/conventions";
import { repository } from "./environment.js";

/** Points, one after the other. */
export type Points = number[][];

/** A mask as several programs encode it. */
export interface MaskFixture {
  name: string;
  width: number;
  height: number;
  /** 0 and 1, row by row. */
  pixels: string;
  coco: string;
  cocoRuns: number[];
  labelStudio: number[];
  cvatPoints: number[];
  cvatElement: { rle: string; left: string; top: string; width: string; height: string };
}

interface Fixtures {
  masks: MaskFixture[];
  meshPoints: Points;
  poses: {
    scale: number;
    quaternionWxyz: number[];
    rotationRows: number[][];
    translation: number[];
    rowMajor: number[];
    points: Record<"opencv" | "opengl" | "pytorch3d" | "ros", Points>;
  }[];
  sam3d: {
    layout: { scale: number[][]; rotation: number[][]; translation: number[][] };
    zUp: Points;
    inOpenCv: Points;
  }[];
  bop: {
    entry: { cam_R_m2c: number[]; cam_t_m2c: number[]; obj_id: number };
    modelMm: Points;
    inCameraMm: Points;
  }[];
  generators: {
    generator: keyof typeof generatorFrames;
    file: "mesh" | "gaussians";
    vertices: Points;
    heights: number[];
    towardsCamera: number[] | null;
  }[];
  moge: { width: number; height: number; intrinsics: number[][]; points: (number | null)[][]; mask: boolean[] };
}

/** The fixtures. */
export const fixtures: Fixtures = JSON.parse(
  readFileSync(join(repository, "tests", "fixtures", "conventions.json"), "utf8"),
);

/** A mask's pixels. */
export const pixelsOf = ({ pixels }: MaskFixture): Uint8Array => Uint8Array.from(pixels, Number);
