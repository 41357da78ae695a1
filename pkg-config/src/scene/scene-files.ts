/** A scene from files: one view, and the mask and the mesh of each object. */
import { type CaseFiles, filesOf, meshFile, type ReadCaseOptions } from "../case-files.js";
import { type KnownPose, parsePoseFile } from "../conventions/pose-file.js";
import type { SceneInput, SceneObjectInput } from "../types/scene.js";
import { failure } from "../values/error.js";
import { naturally } from "../values/order.js";
import { withoutUndefined } from "../values/validation.js";

/** A scene whose files have been read, but not decoded. */
export interface SceneCase {
  /** The input for `alignScene`. */
  input: SceneInput;
  /** The true pose of each object; `null` if unknown. */
  truths: (KnownPose | null)[];
  /** The path of the file of each part: `depth`, `camera`, `image`, `objects/NAME/mask`, … */
  files: Record<string, string>;
  /** The paths of files that were not read, in order. */
  unread: string[];
}

/**
 * Reads a scene folder: the view in it, and `objects/NAME/{mask.*, mesh.*, initial.json, gt.json}`.
 * @param place location of the files, for errors
 * @internal
 */
export async function sceneFrom(
  files: CaseFiles,
  { resizeMask, maskIndex, ...settings }: ReadCaseOptions,
  place = "the files",
): Promise<SceneCase> {
  const names = objectsIn(files);
  const ofView = filesOf(
    within(files, (path) => (isOfObject(path) ? undefined : path)),
    settings,
    place,
  );
  const view = { depth: ofView.required("depth"), camera: ofView.find("camera"), image: ofView.find("image") };
  const depth = await ofView.read(view.depth);
  const [objects, truths, unread]: [SceneObjectInput[], (KnownPose | null)[], string[]] = [[], [], []];
  const found: Record<string, string | undefined> = { ...view };
  for (const name of names) {
    const folder = `objects/${name}/`;
    const inFolder = within(files, (path) => (path.startsWith(folder) ? path.slice(folder.length) : undefined));
    const own = filesOf(inFolder, settings, `${place}/objects/${name}`, `objects/${name}`);
    const { required, find, read, optional } = own;
    const parts = { mask: required("mask"), mesh: required("mesh"), initial: find("initial"), truth: find("truth") };
    const mask = await read(parts.mask);
    const mesh = await meshFile(parts.mesh, await read(parts.mesh), own.beside);
    const [initial, truth] = [await optional(parts.initial), await optional(parts.truth)];
    const pose = initial && parsePoseFile(`${folder}${parts.initial}`, initial)?.transform;
    objects.push({
      name,
      mask,
      mesh,
      ...withoutUndefined({ resizeMask, maskIndex, initial: pose }),
    } as SceneObjectInput);
    truths.push(truth === undefined ? null : parsePoseFile("truth", truth));
    for (const [part, file] of Object.entries(parts)) found[`${folder}${part}`] = file && `${folder}${file}`;
    unread.push(...own.unread().map((path) => `${folder}${path}`));
  }
  if (objects.length === 0) {
    const remedy = 'See "sim3align scene --help" for the layout of a scene folder.';
    throw failure("FILE_NOT_FOUND", "scene", `no objects in ${place}`, "objects/NAME/ with mask and mesh", remedy);
  }
  const { image: _, ...more } = settings;
  const [cameraFile, image] = [await ofView.optional(view.camera), await ofView.optional(view.image)];
  const input = withoutUndefined({ depth, cameraFile, objects, image, ...more }) as SceneInput;
  const read = withoutUndefined(found) as SceneCase["files"];
  return { input, truths, files: read, unread: [...ofView.unread(), ...unread] };
}

const isOfObject = (path: string) => /^objects\/[^/]+\/./.test(path);

/** The names of the folders in `objects/`, in order. */
function objectsIn(files: CaseFiles): string[] {
  const names = Object.keys(files).flatMap((path) => (isOfObject(path) ? (path.split("/")[1] as string) : []));
  return [...new Set(names)].sort(naturally);
}

/** Files by other paths; without those that have none. */
const within = (files: CaseFiles, pathOf: (path: string) => string | undefined): CaseFiles =>
  Object.fromEntries(
    Object.entries(files).flatMap(([path, file]) => {
      const own = pathOf(path);
      return own === undefined ? [] : [[own, file]];
    }),
  );
