/** A scene from files: one view, and the mask and the mesh of each object. */
import { type CaseFiles, fileNotFound, filesOf, INITIAL_FILE, meshFile, type ReadCaseOptions } from "../case-files.js";
import { type KnownPose, parsePoseFile } from "../conventions/pose-file.js";
import type { LoadFormats } from "../modules/readers.js";
import { withoutUndefined } from "../values/values.js";
import type { SceneInput, SceneObjectInput } from "./types.js";

/** A scene whose files have been read, but not decoded. */
export interface SceneCase {
  /** The input for `alignScene`. */
  input: SceneInput;
  /** The true pose of each object; `null` if unknown. */
  truths: (KnownPose | null)[];
}

/**
 * Reads a scene folder: the view in it, and `objects/NAME/{mask.*, mesh.*, initial.json, gt.json}`.
 * @param place location of the files, for errors
 * @internal
 */
export async function sceneFrom(
  files: CaseFiles,
  { resizeMask, ...settings }: ReadCaseOptions,
  formats: LoadFormats,
  place = "the files",
): Promise<SceneCase> {
  const ofView = filesOf(files, settings, place);
  const depth = await ofView.read(ofView.required("depth"));
  const objects: SceneObjectInput[] = [];
  const truths: (KnownPose | null)[] = [];
  for (const name of objectsIn(files)) {
    const own = filesOf(within(files, `objects/${name}/`), settings, `${place}/objects/${name}`, `objects/${name}`);
    const [maskName, meshName] = [own.required("mask"), own.required("mesh")];
    const mask = await own.read(maskName);
    const mesh = await meshFile(meshName, await own.read(meshName), formats, own.beside);
    const [initial, truth] = [await own.optional(INITIAL_FILE), await own.optional("gt.json")];
    const pose = initial && parsePoseFile(`objects/${name}/${INITIAL_FILE}`, initial)?.transform;
    objects.push({ name, mask, mesh, ...withoutUndefined({ resizeMask, initial: pose }) } as SceneObjectInput);
    truths.push(truth === undefined ? null : parsePoseFile("truth", truth));
  }
  if (objects.length === 0) throw fileNotFound("scene", `no objects in ${place}`, "objects/NAME/ with mask and mesh");
  const { image: _, ...view } = settings;
  const [cameraFile, image] = [
    await ofView.optional(ofView.find("camera")),
    await ofView.optional(ofView.find("image")),
  ];
  return { input: withoutUndefined({ depth, cameraFile, objects, image, ...view }) as SceneInput, truths };
}

/** The names of the folders in `objects/`, in order. */
function objectsIn(files: CaseFiles): string[] {
  const names = Object.keys(files).flatMap((path) => /^objects\/([^/]+)\/./.exec(path)?.[1] ?? []);
  return [...new Set(names)].sort();
}

/** The files of a folder, by their paths in it. */
const within = (files: CaseFiles, folder: string): CaseFiles =>
  Object.fromEntries(
    Object.entries(files).flatMap(([path, file]) =>
      path.startsWith(folder) ? [[path.slice(folder.length), file]] : [],
    ),
  );
