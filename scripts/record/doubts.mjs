/**
 * `npm run record -- --doubts`: how often a warning doubts a clean input: generated cases, and folders of cases and scenes. Depth
 * is passed without its unit and the camera without its image size, because what is stated is not doubted. A mesh that fits in no
 * pose is doubted falsely only if the pose is right.
 */
import { existsSync, rmSync } from "node:fs";
import { basename, join } from "node:path";
import { markdownTable, percent, share } from "../bench/table.mjs";
import { cached } from "../lib/cache.mjs";
import { foldersOf } from "../lib/folders.mjs";
import { labCode, runLab } from "../lib/lab.mjs";
import { buildPackage } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { compiledModule, createAligner } from "../speed/inputs.mjs";

/** The warnings that doubt an input. */
const doubts = [
  ...[
    "MASK_LOOKS_INVERTED",
    "MASK_COVERS_IMAGE",
    "MASK_HAS_LABELS",
    "SIZE_DOUBTFUL",
    "CAMERA_DOUBTFUL",
    "MESH_LOOKS_MIRRORED",
  ],
  ...["MESH_DOUBTFUL", "DEPTH_LOOKS_INVERTED", "DEPTH_LOOKS_NORMALISED", "DEPTH_LOOKS_LIKE_MILLIMETRES"],
  ...["DEPTH_LOOKS_TOO_SMALL", "MESH_HOLDS_COPIES", "TEXTURE_LOOKS_FLIPPED"],
];
/** The generated sets, each with its share of the inputs, and the number of inputs of a case. */
const sets = [
  { set: "general", part: 0.3, objects: 1 },
  { set: "sensors", part: 0.2, objects: 1 },
  { set: "colors", part: 0.2, objects: 1 },
  { set: "scenes", part: 0.3, objects: 2 },
];
/** The largest share of false alarms of a doubt. */
const MOST = 0.01;

/** Largest errors of a right pose: of the scale, of the rotation in degrees, of the place relative to the diameter. */
const RIGHT = [0.05, 10, 0.05];

/** @typedef {{ name: string, input: object, truth: any }} Clean */
/** @typedef {{ name: string, codes: string[] }} Doubted */

/**
 * Prints the false alarms of each doubt, by source and as a list.
 * @param {readonly string[]} folders case folders, scene folders, and folders of these
 * @param {number} count of generated inputs
 * @returns {Promise<string[]>} the doubts with too many
 */
export async function falseAlarms(folders, count) {
  await buildPackage();
  const sources = folders.length === 0 ? [] : [{ name: "folders", places: folders, most: Number.POSITIVE_INFINITY }];
  for (const { set, part, objects } of sets) {
    const most = Math.round(part * count);
    sources.push({ name: set, places: [await written(set, Math.ceil(most / objects))], most });
  }
  const aligner = await createAligner({ workers: "auto" });
  /** @type {{ name: string, inputs: Doubted[] }[]} */
  const found = [];
  try {
    for (const { name, places, most } of sources) {
      found.push({ name, inputs: await step(name, async () => doubtedOf(aligner, await inputsIn(places, most))) });
    }
  } finally {
    aligner.dispose();
  }
  const all = found.flatMap(({ inputs }) => inputs);
  const has =
    (/** @type {string} */ code) =>
    (/** @type {Doubted} */ { codes }) =>
      codes.includes(code);
  const rows = doubts.map((code) => [
    ...[code, ...found.map(({ inputs }) => inputs.filter(has(code)).length)],
    percent(share(all.map(has(code)))),
  ]);
  const head = ["false alarms of", ...found.map(({ name, inputs }) => `${name}, ${inputs.length}`), "all %"];
  console.log(`\n${markdownTable(head, rows)}\n`);
  for (const code of doubts) {
    const names = all.filter(has(code)).map(({ name }) => name);
    if (names.length > 0) console.log(`${code}: ${names.join(", ")}`);
  }
  // One alarm of few inputs says nothing.
  return doubts.filter((code) => all.filter(has(code)).length > Math.max(1, MOST * all.length));
}

/** The folder of the generated cases of a set, written once. @param {string} set @param {number} count */
async function written(set, count) {
  const folder = at("target", "bench", "doubts", `${set}-${count}`);
  await cached(`${folder}.done`, labCode(), [folder], async () => {
    rmSync(folder, { recursive: true, force: true });
    await runLab(["bench", "--set", set, "--count", `${count}`, "--seed", "11", "--split", "--write", folder]);
  });
  return folder;
}

/** The first inputs in folders, without what states unit and image size. @param {readonly string[]} places @param {number} most */
async function inputsIn(places, most) {
  const [{ readCaseFolder }, { readSceneFolder }, { resolveInput }, { fileReaders }] = await Promise.all(
    ["case-folder.js", "scene-folder.js", "input/resolve.js", "modules/readers.js"].map(compiledModule),
  );
  const isScene = (/** @type {string} */ folder) => existsSync(join(folder, "objects"));
  const isCase = (/** @type {string} */ folder) => existsSync(join(folder, "camera.json"));
  const inputs = [];
  for (const folder of foldersOf(places, (path) => isScene(path) || isCase(path))) {
    const { input, truth, truths } = isScene(folder) ? await readSceneFolder(folder) : await readCaseFolder(folder);
    const { objects = [{ ...input, truth }], depth: file, cameraFile: from, image } = input;
    for (const [k, { name = "", mask: of, mesh: shape }] of objects.entries()) {
      const seen = { depth: file, cameraFile: from, mask: of, mesh: shape, image };
      const { depth, depthScale = 1, camera, width, height, mask, mesh } = (await resolveInput(seen, fileReaders)).core;
      const metres = Float32Array.from(depth, (/** @type {number} */ z) => z * depthScale);
      const clean = { depth: metres, width, height, mask, mesh, cameraFile: camera, image };
      inputs.push({ name: join(basename(folder), name), input: clean, truth: truths?.[k] ?? truth });
    }
    if (inputs.length >= most) break;
  }
  return inputs.slice(0, most);
}

/** @param {any} aligner @param {readonly Clean[]} inputs @returns {Promise<Doubted[]>} */
async function doubtedOf(aligner, inputs) {
  const found = [];
  for await (const { index, alignment, error } of aligner.alignAll(
    inputs.map(({ input }) => input),
    { metrics: false },
  )) {
    if (error !== undefined) throw error;
    const { name, input, truth } = /** @type {Clean} */ (inputs[index]);
    let codes = alignment.warnings.map((/** @type {{ code: string }} */ { code }) => code);
    if (codes.includes("MESH_DOUBTFUL") && truth !== null) {
      const known = { truth: truth.transform, symmetry: truth.symmetry };
      const { errors } = await aligner.evaluate(input, alignment, known);
      const of = [errors.scaleError, errors.rotationErrorDeg, errors.translationErrorRelative];
      const isRight = of.every((error, i) => error <= (RIGHT[i] ?? 0));
      if (!isRight) codes = codes.filter((/** @type {string} */ code) => code !== "MESH_DOUBTFUL");
    }
    found.push({ name, codes });
  }
  return found;
}
