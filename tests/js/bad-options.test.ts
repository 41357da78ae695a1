/** Bad options: a typed error that says what to do. */
import { test } from "node:test";
import type { AlignOptions, ErrorCode } from "sim3align";
import { aligner } from "../support/bad-input.js";
import { rejectsWith } from "../support/errors.js";
import { input, truth } from "../support/scene.js";

const options: [name: string, options: unknown, code: ErrorCode, argument: string, message: RegExp][] = [
  ["options as text", "paper", "INVALID_ARGUMENT", "options", /string "paper"/],
  ["an unknown option", { qualty: "best" }, "UNKNOWN_OPTION", "options.qualty", /Did you mean `quality`/],
  ["an option that is like no other", { zebra: 1 }, "UNKNOWN_OPTION", "options.zebra", /one of preset, quality.*Check/],
  [
    "an option of the other preset",
    { guard: null },
    "UNKNOWN_OPTION",
    "options.guard",
    /`guard`, which is an option of preset "paper".*Pass `preset: "paper"`/,
  ],
  [
    "the same under preset paper",
    { preset: "paper", quality: "best" },
    "UNKNOWN_OPTION",
    "options.quality",
    /`quality`, which is an option of preset "precise".*Omit `preset`/,
  ],
  [
    "lockScale without the paper's method",
    { lockScale: true },
    "UNKNOWN_OPTION",
    "options.lockScale",
    /preset "paper"/,
  ],
  ["an unknown preset", { preset: "fast" }, "INVALID_OPTION", "options.preset", /precise.*paper/],
  ["a seed below 0", { seed: -1 }, "INVALID_OPTION", "options.seed", /-1/],
  ["a fractional seed", { seed: 0.5 }, "INVALID_OPTION", "options.seed", /0\.5/],
  [
    "voxelDivisions too small",
    { preset: "paper", voxelDivisions: 1 },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /from 5 to 200/,
  ],
  [
    "voxelDivisions as NaN",
    { preset: "paper", voxelDivisions: Number.NaN },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /NaN/,
  ],
  [
    "voxelDivisions as text",
    { preset: "paper", voxelDivisions: "30" },
    "INVALID_OPTION",
    "options.voxelDivisions",
    /30/,
  ],
  [
    "a guard that excludes the initial scale",
    { preset: "paper", guard: [1.2, 1.5] },
    "INVALID_OPTION",
    "options.guard",
    /≤ 1 ≤/,
  ],
  ["a guard of one number", { preset: "paper", guard: [0.5] }, "INVALID_OPTION", "options.guard", /./],
  [
    "an unknown guard mode",
    { preset: "paper", guardMode: "ignore" },
    "INVALID_OPTION",
    "options.guardMode",
    /reject.*clamp/,
  ],
  [
    "too many iterations",
    { preset: "paper", ransacIterations: 1e12 },
    "INVALID_OPTION",
    "options.ransacIterations",
    /./,
  ],
  ["lockScale as a number", { preset: "paper", lockScale: 1 }, "INVALID_OPTION", "options.lockScale", /./],
  ["an unknown quality", { quality: "ultra" }, "INVALID_OPTION", "options.quality", /"ultra".*fast.*balanced.*best/],
  ["a scale of zero", { scale: 0 }, "INVALID_OPTION", "options.scale", /number above 0/],
  ["a scale as another word", { scale: "fixed" }, "INVALID_OPTION", "options.scale", /"fixed".*"free"/],
  ["bounds the wrong way round", { scale: [2, 1] }, "INVALID_OPTION", "options.scale", /\[2, 1\].*min ≤ max/],
  ["bounds by name", { scale: { min: 1, max: 2 } }, "INVALID_OPTION", "options.scale", /\[min, max\]/],
  ["a scale of null", { scale: null }, "INVALID_OPTION", "options.scale", /null.*"free"/],
  ["a known extent below 0", { knownExtentM: -0.1 }, "INVALID_OPTION", "options.knownExtentM", /-0\.1.*above 0/],
  ["an unknown side", { knownExtentAxis: "w" }, "INVALID_OPTION", "options.knownExtentAxis", /longest.*z/],
  ["two known sizes", { scale: 1, knownExtentM: 1 }, "INVALID_OPTION", "options.knownExtentM", /omit one of the two/],
  ["up as zero", { cameraUp: [0, 0, 0], meshUp: [0, 1, 0] }, "INVALID_OPTION", "options.cameraUp", /not all 0/],
  ["up of two numbers", { cameraUp: [0, 1] }, "INVALID_OPTION", "options.cameraUp", /Array of 2.*three/],
  ["up with NaN", { meshUp: [0, Number.NaN, 1] }, "INVALID_OPTION", "options.meshUp", /NaN/],
  ["up in the camera alone", { cameraUp: [0, -1, 0] }, "INVALID_OPTION", "options.meshUp", /in both frames/],
  ["up in the mesh alone", { meshUp: [0, 1, 0] }, "INVALID_OPTION", "options.cameraUp", /in both frames/],
  ["an unknown symmetry", { symmetry: "round" }, "INVALID_OPTION", "options.symmetry", /"round".*"auto-revolution"/],
  ["a symmetry of null", { symmetry: null }, "INVALID_OPTION", "options.symmetry", /null.*"none"/],
  ["an axis of zero", { symmetry: [{ axis: [0, 0, 0] }] }, "INVALID_OPTION", "options.symmetry.axis", /other than 0/],
  ["a fold of 1", { symmetry: [{ axis: [0, 0, 1], fold: 1 }] }, "INVALID_OPTION", "options.symmetry.fold", /2 to 360/],
  ["an unknown search", { search: "nearby" }, "INVALID_OPTION", "options.search", /global.*local/],
  ["a local search from nowhere", { search: "local" }, "INVALID_OPTION", "options.search", /without an initial pose/],
  ["an initial pose that is none", { initial: 5 }, "INVALID_ARGUMENT", "options.initial", /number 5.*matrix/],
  ["an initial pose without parts", { initial: {} }, "INVALID_ARGUMENT", "options.initial", /scale, rotation, transl/],
  [
    "an initial pose of no scale",
    { initial: { ...truth, scale: 0 } },
    "INVALID_TRANSFORM",
    "options.initial",
    /above 0/,
  ],
  [
    "an initial pose with no rotation",
    { initial: { ...truth, rotation: [0, 0, 0, 0] } },
    "INVALID_TRANSFORM",
    "options.initial.rotation",
    /quaternion/,
  ],
  [
    "an initial pose beyond the scale's bounds",
    { initial: truth, scale: [0.1, 0.2] },
    "INVALID_OPTION",
    "options.initial",
    /0\.09.*within `scale`: \[0\.1, 0\.2\]/,
  ],
  ["a budget of zero", { workBudget: 0 }, "INVALID_OPTION", "options.workBudget", /above 0/],
  ["metrics as a word", { metrics: "none" }, "INVALID_OPTION", "options.metrics", /true or false/],
  ["onProgress as text", { onProgress: "log" }, "INVALID_ARGUMENT", "options.onProgress", /function/],
];

for (const [name, value, code, argument, message] of options) {
  const call = () => aligner.align(input, value as AlignOptions);
  test(`${name}: ${code}`, () => rejectsWith(call, { code, argument, message }));
}
