/** The output of SAM 3D Objects as the files of a scene. The guide "Meshes of generators" describes the folder. */
import { type CaseFiles, caseFiles, INITIAL_FILE, type ReadCaseOptions } from "../case-files.js";
import { fromSam3d } from "../conventions/sam3d.js";
import { parsedJson } from "../formats/json.js";
import { holdsGaussians } from "../formats/splat-files.js";
import { requiredBytes } from "../input/bytes.js";
import type { DepthKind } from "../input/types.js";
import type { LoadFormats } from "../modules/readers.js";
import { failure, renamed, Sim3AlignError } from "../values/error.js";
import { flattened, isRecord } from "../values/values.js";
import { viewOfPointMap } from "./point-map-file.js";
import { type SceneCase, sceneFrom } from "./scene-files.js";

/** Names of point maps, in order of preference. */
const pointMaps = ["pointmap", "point_map", "moge", "points"].flatMap((name) => [`${name}.npy`, `${name}.npz`]);

/** Names of files with the depth of an image: depth itself, which is metric, comes first. */
export const viewNames: readonly string[] = [...caseFiles.depth, ...pointMaps];

/** Formats of the mesh of an object, in order of preference: only GLB has materials. */
const meshFormats = ["glb", "obj", "stl", "ply", "splat"];

/** Words in paths that tell the kind of a file, or nothing; the others name the object. */
const kindWords =
  /^(objects?|obj|masks?|mesh|meshes|models?|glbs?|ply|gaussians?|gs|splats?|poses?|layouts?|metadata|outputs?|results?|reconstruction|sam3d|gt|truth)$/i;

/** What the files of one object are. */
interface ObjectPaths {
  mask?: string;
  meshes: string[];
  pose?: string;
  truth?: string;
}

/** A scene folder made of other files. */
export interface MadeScene {
  /** The files of the scene folder. */
  files: CaseFiles;
  /** What its depth is, unless something else is known: point maps of SAM 3D Objects have no unit. */
  depthKind: DepthKind;
}

/**
 * Reads the output of SAM 3D Objects as a scene.
 * @param place location of the files, for errors
 * @internal
 */
export async function sam3dFrom(
  files: CaseFiles,
  settings: ReadCaseOptions,
  formats: LoadFormats,
  place = "the files",
): Promise<SceneCase> {
  const made = await sam3dScene(files, place);
  // A point map of a large image is smaller than the image.
  const { depthKind = made.depthKind, resizeMask = "nearest", ...more } = settings;
  return sceneFrom(made.files, { depthKind, resizeMask, ...more }, formats, place);
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
  const ofObject = (path: string): ObjectPaths => {
    const name = objectName(path.slice(root.length));
    const known = objects.get(name) ?? { meshes: [] };
    objects.set(name, known);
    return known;
  };
  const made: Record<string, CaseFiles[string]> = {};
  const bytesOf = async (path: string) => {
    const file = files[path];
    return requiredBytes(path, typeof file === "function" ? await file() : file);
  };
  const take = (name: string, path: string | undefined) => {
    if (path !== undefined) made[name] = files[path] as CaseFiles[string];
  };
  // Files nearer to the root first: those of the image.
  const level = (path: string) => path.split("/").length;
  const paths = Object.keys(files).sort((a, b) => level(a) - level(b) || (a < b ? -1 : 1));
  const named = (names: readonly string[]) => {
    const found = names.map((name) => paths.find((path) => baseName(path).toLowerCase() === name));
    return found.find((path) => path !== undefined);
  };
  const [view, image] = [named(viewNames), named([...caseFiles.image, "input.png", "input.jpg"])];
  if (view === undefined) throw missing("sam3d", `no point map in ${place}`, "pointmap.npy, or depth.*");
  const isPointMap = pointMaps.includes(baseName(view).toLowerCase());
  if (isPointMap && extension(view) === "npy") {
    const { depth, camera } = viewOfPointMap(view, await bytesOf(view));
    Object.assign(made, { "depth.npy": depth, "camera.json": camera });
  } else take(`depth.${extension(view)}`, view);
  take("camera.json", named(caseFiles.camera));
  take(`image.${image && extension(image)}`, image);
  for (const path of paths) {
    const ending = extension(path);
    const own = ofObject(path);
    if (meshFormats.includes(ending)) own.meshes.push(path);
    else if (ending === "json" && /^(gt|truth)\b/.test(baseName(path))) own.truth ??= path;
    else if (ending === "json" && isPose(parsedJson(path, await bytesOf(path)))) own.pose ??= path;
    else if (isMask(path, ending) && path !== view && path !== image) own.mask ??= path;
  }
  for (const [name, { mask, meshes, pose, truth }] of objects) {
    // Most masks of an image are of objects that were not reconstructed.
    if (meshes.length === 0 && pose === undefined) continue;
    const lacks = (what: string, expected: string) => missing(`objects/${name}`, `no ${what} in ${place}`, expected);
    const rank = (path: string) => meshFormats.indexOf(extension(path));
    const [mesh] = meshes.sort((a, b) => rank(a) - rank(b));
    if (mesh === undefined) throw lacks(`mesh of ${name}`, "mesh.glb, or the PLY of its Gaussians");
    if (mask === undefined) throw lacks(`mask of ${name}`, caseFiles.mask.join(" or "));
    const format = extension(mesh);
    take(`objects/${name}/mask.${extension(mask)}`, mask);
    take(`objects/${name}/mesh.${format}`, mesh);
    take(`objects/${name}/gt.json`, truth);
    const isZUp = format === "splat" || (format === "ply" && holdsGaussians(await bytesOf(mesh), format));
    const initial = pose === undefined ? null : placement(pose, await bytesOf(pose), isZUp);
    if (initial !== null) made[`objects/${name}/${INITIAL_FILE}`] = initial;
  }
  return { files: made, depthKind: isPointMap ? "scale-invariant" : "metric" };
}

function missing(argument: string, found: string, expected: string): Sim3AlignError {
  const remedy = 'See "sim3align scene --help", or the guide "Meshes of generators", for the layout.';
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
  isRecord(json) && ["rotation", "translation", "scale"].every((name) => name in json);

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
