/** Case folders, or scene folders, of a dataset in the layout of BOP. The package's own reader reads it. */
import { copyFileSync, existsSync, linkSync, mkdirSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { basename, extname, join } from "node:path";
import { compiledModule, packageModule } from "../bench/inputs.mjs";
import { failure } from "./failure.mjs";
import { select } from "./selection.mjs";

/** @typedef {import("./selection.mjs").Selected} Selected */

/** JSON files that a selection is made from. */
const facts = ["scene_camera.json", "scene_gt.json", "scene_gt_info.json"];

/** The package's reader of a split. @param {string} folder @param {string} split */
async function open(folder, split) {
  const { BopDataset } = await compiledModule("bop-dataset.js");
  return new BopDataset(folder, split);
}

/**
 * Unpacks what the selected cases need.
 * @param {import("./archives.mjs").Archives} archives
 * @param {string} folder
 * @param {string} split
 * @param {import("./selection.mjs").Selection} selection
 */
export async function unpackBop(archives, folder, split, selection) {
  const { bopName } = await compiledModule("bop-folder.js");
  const { paths } = archives;
  const isFact = (/** @type {string} */ path) =>
    path === "test_targets_bop19.json" ||
    /^models\w*\/models_info\.json$/.test(path) ||
    (path.startsWith(`${split}/`) && facts.includes(basename(path)));
  await archives.extract(folder, paths.filter(isFact));
  const selected = await select(await open(folder, split), selection);
  const models = modelsIn(paths);
  const wanted = new Set(
    selected.flatMap(({ sceneId, imageId, objectId, place }) => {
      const [scene, image] = [`${split}/${bopName(sceneId)}`, bopName(imageId)];
      return [
        `${scene}/depth/${image}.png`,
        `${scene}/mask_visib/${image}_${bopName(place)}.png`,
        ...[".png", ".jpg"].map((ending) => `${scene}/rgb/${image}${ending}`).filter((path) => paths.includes(path)),
        `${models}/obj_${bopName(objectId)}.ply`,
      ];
    }),
  );
  await archives.extract(folder, wanted);
}

/** The models that are aligned, in the order in which the package looks for them. @param {readonly string[]} paths */
const modelsIn = (paths) =>
  ["models", "models_cad", "models_eval"].find((name) => paths.some((path) => path.startsWith(`${name}/obj_`))) ??
  "models";

/**
 * @typedef {object} Made
 * @property {string} folder of the dataset
 * @property {string} split
 * @property {string} out a new folder
 * @property {import("./selection.mjs").Selection} selection
 * @property {boolean} scenes a scene folder for each image instead of a case folder for each object
 * @property {Record<string, unknown>} source for `meta.json`: where it is from, and under which licence
 */

/**
 * Writes the folders, and returns their number and that of the objects. Depth, masks and photos are those of the dataset, and
 * meshes its models, in millimetres: the scale of `gt.json` is .001 m.
 * @param {Made} options
 */
export async function makeCases({ folder, split, out, selection, scenes, source }) {
  const dataset = await open(folder, split);
  const { bopMaskPath, bopId, bopName } = await compiledModule("bop-folder.js");
  const selected = await select(dataset, selection);
  const models = await dataset.models();
  const info = await dataset.info().catch(() => new Map());
  rmSync(out, { recursive: true, force: true });
  const folders = new Set();
  for (const each of selected) {
    const { sceneId, imageId, objectId, place, visible } = each;
    const scene = await dataset.scene(sceneId);
    const truth = scene.truths.get(bopId(imageId))?.[place];
    if (truth === undefined) continue;
    const image = `${bopName(sceneId)}-${bopName(imageId)}`;
    const object = `${bopName(objectId)}-${place}`;
    const home = join(out, scenes ? image : `${image}-${object}`);
    const own = scenes ? join(home, "objects", object) : home;
    mkdirSync(own, { recursive: true });
    if (!folders.has(home)) await writeImage(home, scene, imageId);
    folders.add(home);
    put(bopMaskPath(scene, bopId(imageId), place), join(own, "mask.png"));
    put(join(models, `obj_${bopName(objectId)}.ply`), join(own, "mesh.ply"));
    writeJson(join(own, "gt.json"), await truthOf(truth, info.get(objectId)));
    writeJson(join(own, "meta.json"), { ...source, split, ...each, visible });
  }
  if (folders.size === 0) {
    const remedy = "lower --visible, name a split whose poses are public with --split, or see the dataset's layout";
    throw failure("NO_CASES", join(folder, split), "no object that fits", "objects with public poses", remedy);
  }
  return { folders: folders.size, objects: selected.length };
}

/**
 * The files that all objects of an image share.
 * @param {string} home
 * @param {any} scene
 * @param {number} imageId
 */
async function writeImage(home, scene, imageId) {
  const { bopId, bopName } = await compiledModule("bop-folder.js");
  const { parseCameraFile } = await compiledModule("formats/camera-file.js");
  const depth = join(scene.folder, "depth", `${bopName(imageId)}.png`);
  if (!existsSync(depth)) {
    const remedy = "choose another split: depth in other formats than PNG is not read";
    throw failure("NO_CASES", depth, "no such file", "depth as a 16-bit PNG", remedy);
  }
  put(depth, join(home, "depth.png"));
  const { fx, fy, cx, cy, depthScale = 0.001 } = parseCameraFile(scene.cameraFile, { imageId: bopId(imageId) });
  writeJson(join(home, "camera.json"), { fx, fy, cx, cy, depthScale });
  const photos = existsSync(join(scene.folder, "rgb")) ? readdirSync(join(scene.folder, "rgb")) : [];
  const photo = photos.find((name) => [".png", ".jpg"].some((ending) => name === `${bopName(imageId)}${ending}`));
  if (photo !== undefined) put(join(scene.folder, "rgb", photo), join(home, `rgb${extname(photo)}`));
}

/**
 * `gt.json`: the pose of BOP as a similarity, and its symmetries in the words that all readers know.
 * @param {any} pose
 * @param {{ discrete: Float64Array, continuous: Float64Array } | undefined} info
 */
async function truthOf(pose, info) {
  const { fromBop } = await packageModule("conventions.js");
  const { scale, rotationMatrix, translation } = fromBop(pose);
  const kind = info?.continuous.length ? "continuous" : info?.discrete.length ? "discrete" : "none";
  return { available: true, scale, rotation: rotationMatrix, translation, symmetry: kind };
}

/** A file at another place: the same bytes, where the file system allows. @param {string} from @param {string} to */
function put(from, to) {
  try {
    linkSync(from, to);
  } catch {
    copyFileSync(from, to);
  }
}

/** @param {string} path @param {unknown} content */
const writeJson = (path, content) => writeFileSync(path, `${JSON.stringify(content, null, 2)}\n`);
