/** Bad options: a typed error that says what to do. */
import type { AlignOptions } from "sim3align";
import { aligner } from "../support/bad-input.js";
import { type Refusals, refuses } from "../support/errors.js";
import { input, truth } from "../support/scene.js";

const options: Refusals<unknown> = {
  "options as text: INVALID_ARGUMENT options": ["paper", /string "paper"/],
  "an unknown option: UNKNOWN_OPTION options.qualty": [{ qualty: "best" }, /Did you mean `quality`/],
  "a misspelt listener: UNKNOWN_OPTION options.onprogress": [{ onprogress: () => {} }, /Did you mean `onProgress`/],
  "an option of createAligner: UNKNOWN_OPTION options.workers": [
    { workers: 4 },
    /`workers`, which is an option of createAligner.*createAligner\(\{ workers \}\)/,
  ],
  "a seed without constructor: INVALID_OPTION options.seed": [{ seed: Object.create(null) }, /an object|Object/],
  "a seed without class: INVALID_OPTION options.seed": [{ seed: { constructor: null } }, /an object/],
  "an option that is like no other: UNKNOWN_OPTION options.zebra": [
    { zebra: 1 },
    /one of preset, signal, transfer, onProgress, quality.*Check/,
  ],
  "an option of the other preset: UNKNOWN_OPTION options.guard": [
    { guard: null },
    /`guard`, which is an option of preset "paper".*Pass `preset: "paper"`/,
  ],
  "the same under preset paper: UNKNOWN_OPTION options.quality": [
    { preset: "paper", quality: "best" },
    /`quality`, which is an option of preset "precise".*Omit `preset`/,
  ],
  "lockScale without the paper's method: UNKNOWN_OPTION options.lockScale": [{ lockScale: true }, /preset "paper"/],
  "an unknown preset: INVALID_OPTION options.preset": [{ preset: "fast" }, /precise.*paper/],
  "a seed below 0: INVALID_OPTION options.seed": [{ seed: -1 }, /-1/],
  "a fractional seed: INVALID_OPTION options.seed": [{ seed: 0.5 }, /0\.5/],
  "voxelDivisions too small: INVALID_OPTION options.voxelDivisions": [
    { preset: "paper", voxelDivisions: 1 },
    /from 5 to 200/,
  ],
  "voxelDivisions as NaN: INVALID_OPTION options.voxelDivisions": [
    { preset: "paper", voxelDivisions: Number.NaN },
    /NaN/,
  ],
  "voxelDivisions as text: INVALID_OPTION options.voxelDivisions": [{ preset: "paper", voxelDivisions: "30" }, /30/],
  "a guard that excludes the initial scale: INVALID_OPTION options.guard": [
    { preset: "paper", guard: [1.2, 1.5] },
    /≤ 1 ≤/,
  ],
  "a guard of one number: INVALID_OPTION options.guard": [{ preset: "paper", guard: [0.5] }],
  "an unknown guard mode: INVALID_OPTION options.guardMode": [
    { preset: "paper", guardMode: "ignore" },
    /reject.*clamp/,
  ],
  "too many iterations: INVALID_OPTION options.ransacIterations": [{ preset: "paper", ransacIterations: 1e12 }],
  "lockScale as a number: INVALID_OPTION options.lockScale": [{ preset: "paper", lockScale: 1 }],
  "an unknown quality: INVALID_OPTION options.quality": [{ quality: "ultra" }, /"ultra".*fast.*balanced.*best/],
  "a scale of zero: INVALID_OPTION options.scale": [{ scale: 0 }, /number above 0/],
  "a scale as another word: INVALID_OPTION options.scale": [{ scale: "fixed" }, /"fixed".*"free"/],
  "bounds the wrong way round: INVALID_OPTION options.scale": [{ scale: [2, 1] }, /\[2, 1\].*min ≤ max/],
  "bounds by name: INVALID_OPTION options.scale": [{ scale: { min: 1, max: 2 } }, /\[min, max\]/],
  "a scale of null: INVALID_OPTION options.scale": [{ scale: null }, /null.*"free"/],
  "a known extent below 0: INVALID_OPTION options.knownExtentM": [{ knownExtentM: -0.1 }, /-0\.1.*above 0/],
  "an unknown side: INVALID_OPTION options.knownExtentAxis": [{ knownExtentAxis: "w" }, /longest.*z/],
  "two known sizes: INVALID_OPTION options.knownExtentM": [{ scale: 1, knownExtentM: 1 }, /omit one of the two/],
  "up as zero: INVALID_OPTION options.cameraUp": [{ cameraUp: [0, 0, 0], meshUp: [0, 1, 0] }, /not all 0/],
  "up of two numbers: INVALID_OPTION options.cameraUp": [{ cameraUp: [0, 1] }, /Array of 2.*three/],
  "up with NaN: INVALID_OPTION options.meshUp": [{ meshUp: [0, Number.NaN, 1] }, /NaN/],
  "up in the camera alone: INVALID_OPTION options.meshUp": [{ cameraUp: [0, -1, 0] }, /in both frames/],
  "up in the mesh alone: INVALID_OPTION options.cameraUp": [{ meshUp: [0, 1, 0] }, /in both frames/],
  "an unknown symmetry: INVALID_OPTION options.symmetry": [{ symmetry: "round" }, /"round".*"auto"/],
  "a symmetry of null: INVALID_OPTION options.symmetry": [{ symmetry: null }, /null.*"none"/],
  "an axis of zero: INVALID_OPTION options.symmetry.axis": [{ symmetry: [{ axis: [0, 0, 0] }] }, /other than 0/],
  "a fold of 1: INVALID_OPTION options.symmetry.fold": [{ symmetry: [{ axis: [0, 0, 1], fold: 1 }] }, /2 to 360/],
  "an unknown search: INVALID_OPTION options.search": [{ search: "nearby" }, /global.*local/],
  "a local search from nowhere: INVALID_OPTION options.search": [{ search: "local" }, /without an initial pose/],
  "an initial pose that is none: INVALID_ARGUMENT options.initial": [{ initial: 5 }, /number 5.*matrix/],
  "an initial pose without parts: INVALID_ARGUMENT options.initial": [{ initial: {} }, /scale, rotation, transl/],
  "an initial pose of no scale: INVALID_TRANSFORM options.initial": [{ initial: { ...truth, scale: 0 } }, /above 0/],
  "an initial pose with no rotation: INVALID_TRANSFORM options.initial.rotation": [
    { initial: { ...truth, rotation: [0, 0, 0, 0] } },
    /quaternion/,
  ],
  "an initial pose beyond the scale's bounds: INVALID_OPTION options.initial": [
    { initial: truth, scale: [0.1, 0.2] },
    /0\.09.*within `scale`: \[0\.1, 0\.2\]/,
  ],
  "a budget of zero: INVALID_OPTION options.workBudget": [{ workBudget: 0 }, /above 0/],
  "metrics as a word: INVALID_OPTION options.metrics": [{ metrics: "none" }, /true or false/],
  "onProgress as text: INVALID_ARGUMENT options.onProgress": [{ onProgress: "log" }, /function/],
};

refuses(options, (value) => aligner.align(input, value as AlignOptions));
