/** The output of SAM 3D Objects as the files of a scene. The guide "Scenes, and outputs of generators" describes the folder. */
import type { CaseFiles, ReadCaseOptions } from "../case-files.js";
import { isNoInput, namesOf, partOf } from "../case-names.js";
import { fromSam3d } from "../conventions/sam3d.js";
import { requiredBytes } from "../input/bytes.js";
import { holdsGaussians } from "../input/splat-files.js";
import type { DepthKind } from "../types/inputs.js";
import { failure, renamed, Sim3AlignError } from "../values/error.js";
import { parsedJson } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { naturally } from "../values/order.js";
import { flattened } from "../values/validation.js";
import { type SceneCase, sceneFrom } from "./scene-files.js";

/** Names of point maps, in order of preference. */
const pointMaps = ["pointmap", "point_map", "moge", "points"].flatMap((name) => [`${name}.npy`, `${name}.npz`]);

/** Names of files with the depth of an image: depth itself, which is metric, comes first. */
const viewNames: readonly string[] = [...namesOf("depth"), ...pointMaps];

/** The point map that sam3d_asset_extractor writes for each object: all are of the same image. */
const ofObject = /_pointmap_full\.npz$/i;

/** Whether a path is that of a point map. */
export const isPointMap = (path: string): boolean =>
  pointMaps.includes(baseName(path).toLowerCase()) || ofObject.test(path);

/** Whether a name is that of a file with the depth of an image. */
export const isView = (name: string): boolean => viewNames.includes(name.toLowerCase()) || ofObject.test(name);

/** Formats of the mesh of an object, in order of preference: only GLB has materials. */
const meshFormats = ["glb", "obj", "stl", "ply", "splat"];

/** Words in paths that tell the kind of a file, or nothing; the others name the object. */
const kindWords =
  /^(objects?|obj|masks?|mesh|meshes|models?|glbs?|ply|gaussians?|gs|splats?|poses?|layouts?|metadata|outputs?|results?|reconstruction|sam[23]d?|gt|truth|pointmap|full)$/i;

/** Files of sam3d_asset_extractor that repeat others: pictures of masks, meshes in the camera's frame, points as PLY. */
const repeated = /(^|\/)vis_[^/]*$|_pose(_mesh[^/]*)?\.(ply|glb|obj)$|_pointmap_full\.ply$/i;

/** The files of one object. */
interface ObjectPaths {
  masks: string[];
  meshes: string[];
  poses: string[];
  truths: string[];
}

/** A scene folder made of other files. */
export interface MadeScene {
  /** The files of the scene folder. */
  files: CaseFiles;
  /** The kind of its depth, unless a file states another: point maps of SAM 3D Objects have no unit. */
  depthKind: DepthKind;
  /** The paths of the files that these were made of, by their names. */
  sources: Readonly<Record<string, string>>;
}

/**
 * Reads the output of SAM 3D Objects as a scene.
 * @param place location of the files, for errors
 * @internal
 */
export async function sam3dFrom(files: CaseFiles, settings: ReadCaseOptions, place = "the files"): Promise<SceneCase> {
  const made = await sam3dScene(files, place);
  // A point map of a large image is smaller than the image.
  const { depthKind = made.depthKind, resizeMask = "nearest", ...more } = settings;
  const scene = await sceneFrom(made.files, { depthKind, resizeMask, ...more }, place);
  const named = Object.entries(scene.files).map(([part, name]) => [part, made.sources[name] ?? name]);
  const used = new Set(Object.values(made.sources));
  const isLeft = (path: string) => !used.has(path) && !isNoInput(path);
  return { ...scene, files: Object.fromEntries(named), unread: Object.keys(files).filter(isLeft).sort(naturally) };
}

/**
 * The files of a scene folder, from those of an output of SAM 3D Objects: names and frames are converted, images and meshes
 * are unchanged.
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` for missing parts; for poses that are none, the errors of `fromSam3d`,
 * with the names of their files
 */
export async function sam3dScene(files: CaseFiles, place: string): Promise<MadeScene> {
  const root = commonFolder(Object.keys(files));
  const objects = new Map<string, ObjectPaths>();
  const objectOf = (path: string): ObjectPaths => {
    const name = objectName(path.slice(root.length));
    const known = objects.get(name) ?? { masks: [], meshes: [], poses: [], truths: [] };
    objects.set(name, known);
    return known;
  };
  const made: Record<string, CaseFiles[string]> = {};
  const sources: Record<string, string> = {};
  const bytesOf = async (path: string) => {
    const file = files[path];
    return requiredBytes(path, typeof file === "function" ? await file() : file);
  };
  const take = (name: string, path: string | undefined, content = path && files[path]) => {
    if (path === undefined) return;
    made[name] = content as CaseFiles[string];
    sources[name] = path;
  };
  /** The only one of several files, such as two views of an object, none of which is better than another. */
  const only = (owner: string, what: string, paths: readonly string[]): string | undefined => {
    if (paths.length < 2) return paths[0];
    const remedy = "Keep the files of one view, or rename those that are not meant.";
    throw failure("INVALID_ARGUMENT", owner, `${paths.join(" and ")} in ${place}`, `one ${what}`, remedy);
  };
  // Files nearer to the root first: those of the image.
  const level = (path: string) => path.split("/").length;
  const all = Object.keys(files).sort((a, b) => level(a) - level(b) || naturally(a, b));
  const paths = all.filter((path) => !repeated.test(path));
  const nearest = (what: string, isOne: (name: string) => boolean) => {
    const found = paths.filter((path) => isOne(baseName(path).toLowerCase()));
    return only(
      "sam3d",
      what,
      found.filter((path) => level(path) === level(found[0] as string)),
    );
  };
  const named = viewNames.filter((name) => paths.some((path) => baseName(path).toLowerCase() === name));
  const view = nearest("view", (name) => name === named[0]) ?? paths.find((path) => ofObject.test(path));
  const image = nearest("photo", (name) => partOf(name) === "image" || /^input\.(png|jpg)$/.test(name));
  if (view === undefined) throw missing("sam3d", `no point map in ${place}`, "pointmap.npy, or depth.*");
  const isPoints = isPointMap(view);
  const cameraFile = nearest("camera", (name) => partOf(name) === "camera");
  take(`depth.${extension(view)}`, view);
  take(`camera.${cameraFile && extension(cameraFile)}`, cameraFile);
  take(`image.${image && extension(image)}`, image);
  for (const path of paths) {
    const ending = extension(path);
    const own = objectOf(path);
    if (meshFormats.includes(ending)) own.meshes.push(path);
    else if (ending === "json" && /^(gt|truth)\b/.test(baseName(path))) own.truths.push(path);
    else if (ending === "json" && isPose(parsedJson(path, await bytesOf(path)))) own.poses.push(path);
    else if (isMask(path, ending) && path !== view && path !== image) own.masks.push(path);
  }
  for (const [name, { masks, meshes, poses, truths }] of objects) {
    // Most masks of an image are of objects that were not reconstructed.
    if (meshes.length === 0 && poses.length === 0) continue;
    const owner = `objects/${name}`;
    const lacks = (what: string, expected: string) => missing(owner, `no ${what} in ${place}`, expected);
    const rank = (path: string) => meshFormats.indexOf(extension(path));
    const best = Math.min(...meshes.map(rank));
    const mesh = only(
      owner,
      "mesh",
      meshes.filter((path) => rank(path) === best),
    );
    // Pictures of an object are no masks if another one is by its name.
    const namedMasks = masks.filter((path) => /(^|[^a-z])masks?([^a-z]|$)/i.test(baseName(path)));
    const mask = only(owner, "mask", namedMasks.length > 0 ? namedMasks : masks);
    if (mesh === undefined) throw lacks(`mesh of ${name}`, "mesh.glb, or the PLY of its Gaussians");
    if (mask === undefined) throw lacks(`mask of ${name}`, namesOf("mask").join(" or "));
    const format = extension(mesh);
    take(`${owner}/mask.${extension(mask)}`, mask);
    take(`${owner}/mesh.${format}`, mesh);
    take(`${owner}/gt.json`, only(owner, "true pose", truths));
    const isZUp = format === "splat" || (format === "ply" && holdsGaussians(await bytesOf(mesh), format));
    const pose = only(owner, "pose", poses);
    const initial = pose === undefined ? null : placement(pose, await bytesOf(pose), isZUp);
    if (initial !== null) take(`${owner}/initial.json`, pose, initial);
  }
  return { files: made, depthKind: isPoints ? "scale-invariant" : "metric", sources };
}

function missing(argument: string, found: string, expected: string): Sim3AlignError {
  const remedy = 'See "sim3align scene --help", or the guide "Scenes, and outputs of generators", for the layout.';
  return failure("FILE_NOT_FOUND", argument, found, expected, remedy);
}

/** The name of an object in a path: its words that tell no kind, or `object`. Numbers are the same with and without zeros. */
function objectName(path: string): string {
  const words = path.replace(/\.[^./]+$/, "").split(/[/_.\s-]+/);
  const own = words.filter((word) => word !== "" && !kindWords.test(word));
  const names = own.map((word) => (/^\d+$/.test(word) ? `${Number(word)}` : word));
  return [...new Set(names)].join("-") || "object";
}

/** The folder that all paths are in, with its slash. */
function commonFolder([first = "", ...more]: readonly string[]): string {
  let folder = first.slice(0, first.lastIndexOf("/") + 1);
  while (!more.every((path) => path.startsWith(folder))) {
    folder = folder.slice(0, folder.slice(0, -1).lastIndexOf("/") + 1);
  }
  return folder;
}

const baseName = (path: string) => path.slice(path.lastIndexOf("/") + 1);
const extension = (path: string) => /\.([^./]+)$/.exec(path)?.[1]?.toLowerCase() ?? "";

const isPose = (json: unknown): json is Record<"rotation" | "translation" | "scale", unknown> =>
  isRecord(json) && ["rotation", "translation", "scale"].every((name) => name in json) && !isRecord(json.rotation);

/** Whether a file may be a mask. Of arrays and of JSON, only the name tells. */
const isMask = (path: string, ending: string) =>
  ending === "png" || ((ending === "npy" || ending === "json") && /mask/i.test(baseName(path)));

/**
 * A pose file with where SAM 3D Objects put the mesh. Its size is the mean of the three, as its own refinement takes it; where
 * it differs along the axes, only the `proportions` of an alignment can say which is right. `null` for a placement that
 * reaches the camera, which can be no candidate.
 */
function placement(path: string, bytes: Uint8Array, isZUp: boolean): Uint8Array | null {
  const layout = parsedJson(path, bytes) as Parameters<typeof fromSam3d>[0];
  const scales = flattened(layout.scale) as number[] | null;
  const isSize = scales?.length === 3 && scales.every((scale) => scale > 0);
  const scale = isSize ? scales.reduce((sum, one) => sum + one / 3, 0) : layout.scale;
  try {
    const pose = fromSam3d({ ...layout, scale }, { vertices: isZUp ? "z-up" : "glb" });
    // Meshes are within half a unit of their origin along each axis.
    if (pose.translation[2] <= pose.scale) return null;
    return new TextEncoder().encode(JSON.stringify({ matrix: pose.matrix }));
  } catch (error) {
    throw error instanceof Sim3AlignError ? renamed(error, path) : error;
  }
}
