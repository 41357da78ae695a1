/** The page's samples: committed in `www/samples`, written by the lab's generator from seeds. */
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { cached, digest, once } from "./cache.mjs";
import { runTestedLab as lab } from "./lab.mjs";
import { buildPackage } from "./package.mjs";
import { at, packageDir, sampleDir } from "./paths.mjs";
import { pictureOf } from "./sample-picture.mjs";

/** A folder for each sample, and `index.json`, which lists them. */
export const pageSamplesDir = at("www", "samples");

/**
 * An object of a sample; paths are relative to `index.json`.
 * @typedef {{ id: string, title: string, mask: string, mesh: string, truth: string }} SampleObject
 */

/**
 * A sample as `index.json` lists it: all its objects were seen by one camera.
 * @typedef {{ id: string, title: string, about: string, depth: string, camera: string, photo?: string, picture?: string,
 *   objects: SampleObject[] }} Sample
 */

/** A scene with a photo. It comes first: the page opens it. */
const table = {
  id: "table",
  seed: 1,
  title: "Table",
  about: "Three objects and a photo.",
  objects: ["teapot", "mug", "box"],
};

/** The samples that the page shows as pictures, beside the first one. */
const pictured = ["desk", "hammer"];

/** Samples of one object. */
const kinds = [
  { id: "mug", seed: 1, title: "Mug", about: "The generator invented what it could not see." },
  { id: "hammer", seed: 2, title: "Hammer", about: "Long, and nearly symmetric under a half turn." },
  { id: "spoon", seed: 2, title: "Spoon", about: "A few millimetres thin." },
  { id: "occluded", seed: 4, title: "Teapot behind a mug", about: "A third of it is hidden." },
];

/** A scene of several objects. */
const desk = { id: "desk", setSeed: 0, title: "Desk", about: "Three objects that occlude one another, one depth map." };

/** Copies the first sample, with its depth as .npy, to where tests, examples and `npm run profile` look for it. */
export const copySample = once(async () => {
  await buildPackage();
  const copies = [sampleDir, at("examples", "sample", "mug")];
  const source = join(pageSamplesDir, "mug");
  const outputs = copies.map((folder) => join(folder, "depth.npy"));
  await cached(
    at("target", "samples", "copied-from"),
    digest([source, at("scripts", "lib", "sample.mjs")]),
    outputs,
    async () => {
      const { readDepth } = await import(pathToFileURL(join(packageDir, "formats.js")).href);
      const { depthScale, ...camera } = JSON.parse(readFileSync(join(source, "camera.json"), "utf8"));
      const { data, width, height } = await readDepth(readFileSync(join(source, "depth.png")), { depthScale });
      for (const folder of copies) {
        rmSync(folder, { recursive: true, force: true });
        cpSync(source, folder, { recursive: true, filter: (path) => !path.endsWith("depth.png") });
        writeFileSync(join(folder, "depth.npy"), npy(data, [height, width]));
        writeFileSync(join(folder, "camera.json"), `${JSON.stringify(camera, null, 2)}\n`);
      }
    },
  );
});

/**
 * A .npy file.
 * @param {Float32Array} values
 * @param {readonly number[]} shape
 */
function npy(values, shape) {
  const header = `{'descr': '<f4', 'fortran_order': False, 'shape': (${shape.join(", ")}), }`;
  const length = Math.ceil((header.length + 11) / 64) * 64 - 10;
  const start = Buffer.alloc(10 + length, " ");
  start.write("\x93NUMPY\x01\x00", "latin1");
  start.writeUInt16LE(length, 8);
  start.write(header, 10);
  start.write("\n", 9 + length);
  return Buffer.concat([start, Buffer.from(values.buffer)]);
}

/**
 * Generates all samples.
 * @param {string} folder as {@link pageSamplesDir}
 */
export async function generateSamples(folder) {
  rmSync(folder, { recursive: true, force: true });
  /** @type {Sample[]} */
  const samples = [await generateTable(folder)];
  for (const { id, seed, title, about } of kinds) {
    await lab(["case", join(folder, id), "--kind", id, "--seed", `${seed}`, "--depth", "png"]);
    samples.push({ id, title, about, ...sceneFiles(id), objects: [{ id, title, ...objectFiles(id) }] });
  }
  samples.push(await generateDesk(folder));
  for (const sample of samples) {
    if (sample.photo === undefined && !pictured.includes(sample.id)) continue;
    sample.picture = `${sample.id}/picture.png`;
    writeFileSync(join(folder, sample.picture), await pictureOf(folder, sample));
  }
  writeFileSync(join(folder, "index.json"), `${JSON.stringify(samples, null, 2)}\n`);
}

/**
 * Generates the case folders of a scene, and moves what they share into one place.
 * @param {string} samples
 * @returns {Promise<Sample>}
 */
async function generateDesk(samples) {
  const { id, setSeed, title, about } = desk;
  const made = at("target", "samples", "scenes");
  rmSync(made, { recursive: true, force: true });
  await lab(["scenes", made, "--scenes", "1", "--set-seed", `${setSeed}`, "--prior", "detailed"]);
  const cases = join(made, "detailed");
  const names = readdirSync(cases).sort();
  const objects = names.map((name) => {
    const { family } = JSON.parse(readFileSync(join(cases, name, "meta.json"), "utf8"));
    const folder = join(samples, id, family);
    mkdirSync(folder, { recursive: true });
    for (const file of ["mask.png", "mesh.glb", "gt.json"]) cpSync(join(cases, name, file), join(folder, file));
    return { id: family, title: `${family[0]?.toUpperCase()}${family.slice(1)}`, ...objectFiles(`${id}/${family}`) };
  });
  // Depth and camera are the same for all.
  for (const file of ["depth.png", "camera.json"]) cpSync(join(cases, names[0] ?? "", file), join(samples, id, file));
  return { id, title, about, ...sceneFiles(id), objects };
}

/**
 * Generates the scene with a photo.
 * @param {string} samples
 * @returns {Promise<Sample>}
 */
async function generateTable(samples) {
  const { id, seed, title, about } = table;
  await lab(["case", join(samples, id), "--kind", "table", "--seed", `${seed}`]);
  const objects = table.objects.map((name) => {
    const title = `${name[0]?.toUpperCase()}${name.slice(1)}`;
    return { id: name, title, ...objectFiles(`${id}/objects/${name}`) };
  });
  return { id, title, about, ...sceneFiles(id), photo: `${id}/rgb.png`, objects };
}

/** @param {string} folder */
const sceneFiles = (folder) => ({ depth: `${folder}/depth.png`, camera: `${folder}/camera.json` });

/** @param {string} folder */
const objectFiles = (folder) => ({
  mask: `${folder}/mask.png`,
  mesh: `${folder}/mesh.glb`,
  truth: `${folder}/gt.json`,
});
