/** The samples: seeded, made by the crate's own generator. */
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { digest, Stamp } from "./stamp.mjs";
import { step } from "./step.mjs";

/** The sample's case folder. */
export const sampleDir = at("target", "samples", "mug");

/** The page's samples: a folder each, and `index.json`, which lists them. */
export const pageSamplesDir = at("www", "samples");

/**
 * An object of a sample; paths are relative to `index.json`.
 * @typedef {{ id: string, title: string, mask: string, mesh: string, truth: string }} SampleObject
 */

/**
 * A sample as `index.json` lists it: all its objects were seen by one camera.
 * @typedef {{ id: string, title: string, about: string, depth: string, camera: string, objects: SampleObject[] }} Sample
 */

const mug = { id: "mug", seed: 1, title: "Mug", about: "What the generator could not see, it invented." };

/** Samples of one object; the seeds are those of pretty pictures. */
const kinds = [
  mug,
  { id: "hammer", seed: 2, title: "Hammer", about: "Long, and almost the same turned half round." },
  { id: "spoon", seed: 2, title: "Spoon", about: "A few millimetres thin." },
  { id: "occluded", seed: 4, title: "Teapot behind a mug", about: "A third of it is hidden." },
];

/** A scene of several objects. */
const desk = { id: "desk", setSeed: 0, title: "Desk", about: "Three objects that hide one another, one depth map." };

/** Makes the sample and those of the page, and gives the examples a copy of the first. */
export async function makeSample() {
  await step("samples", async (say) => {
    const sources = [at("src"), at("Cargo.toml"), at("Cargo.lock"), at("scripts", "lib", "sample.mjs")];
    const index = join(pageSamplesDir, "index.json");
    const copy = at("examples", "sample", "mug");
    const outputs = [index, join(sampleDir, "mesh.glb"), join(copy, "mesh.glb")];
    const stamp = new Stamp(at("target", "samples", "made-from"), digest(sources), outputs);
    if (stamp.isCurrent) return say("up to date");
    stamp.clear();
    rmSync(sampleDir, { recursive: true, force: true });
    rmSync(pageSamplesDir, { recursive: true, force: true });
    await generateKind(mug, sampleDir, "npy");
    cpSync(sampleDir, copy, { recursive: true });
    const samples = [];
    for (const kind of kinds) samples.push(await makeKind(kind));
    samples.push(await makeDesk());
    writeFileSync(index, `${JSON.stringify(samples, null, 2)}\n`);
    stamp.write();
    say(samples.map(({ id }) => id).join(", "));
  });
}

/** @param {string[]} args */
const generate = (args) =>
  run("cargo", ["run", "--quiet", "--package", "sim3align-lab", "--", "case", ...args]);

/**
 * @param {typeof mug} kind
 * @param {string} folder
 * @param {"npy" | "png"} depth
 */
const generateKind = ({ id, seed }, folder, depth) =>
  generate([folder, "--kind", id, "--seed", `${seed}`, "--depth", depth]);

/**
 * @param {typeof mug} kind
 * @returns {Promise<Sample>}
 */
async function makeKind(kind) {
  const { id, title, about } = kind;
  await generateKind(kind, join(pageSamplesDir, id), "png");
  return { id, title, about, ...sceneFiles(id), objects: [{ id, title, ...objectFiles(id) }] };
}

/**
 * The scene's case folders, with what they share in one place.
 * @returns {Promise<Sample>}
 */
async function makeDesk() {
  const { id, setSeed, title, about } = desk;
  const made = at("target", "samples", "scenes");
  rmSync(made, { recursive: true, force: true });
  await generate(["scenes", made, "--scenes", "1", "--set-seed", `${setSeed}`, "--prior", "detailed"]);
  const cases = join(made, "detailed");
  const objects = readdirSync(cases)
    .sort()
    .map((name) => {
      const { family } = JSON.parse(readFileSync(join(cases, name, "meta.json"), "utf8"));
      const folder = join(pageSamplesDir, id, family);
      mkdirSync(folder, { recursive: true });
      for (const file of ["mask.png", "mesh.glb", "gt.json"]) cpSync(join(cases, name, file), join(folder, file));
      // Depth and camera are the same for all: the last one's stay.
      for (const file of ["depth.png", "camera.json"]) cpSync(join(cases, name, file), join(folder, "..", file));
      const capital = `${family[0]?.toUpperCase()}${family.slice(1)}`;
      return { id: family, title: capital, ...objectFiles(`${id}/${family}`) };
    });
  return { id, title, about, ...sceneFiles(id), objects };
}

/** @param {string} folder */
const sceneFiles = (folder) => ({ depth: `${folder}/depth.png`, camera: `${folder}/camera.json` });

/** @param {string} folder */
const objectFiles = (folder) => ({
  mask: `${folder}/mask.png`,
  mesh: `${folder}/mesh.glb`,
  truth: `${folder}/gt.json`,
});
