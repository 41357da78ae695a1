/**
 * Readers for scenes, the input of `Aligner.alignScene`: scene folders, and what SAM 3D Objects returns for an image.
 * @packageDocumentation
 */
import { type CaseFiles, type CaseSettings, ownFiles } from "./case-files.js";
import { formatsModule } from "./formats-module.js";
import { sam3dFrom } from "./scene/sam3d-files.js";
import { type SceneFiles, sceneFrom } from "./scene/scene-files.js";
import { ownOptions } from "./snapshot.js";
import { withoutUndefined } from "./values.js";

export type { CaseFiles, CaseSettings } from "./case-files.js";
export type { KnownPose } from "./conventions/pose-file.js";
export { type ErrorCode, type ErrorParts, Sim3AlignError } from "./error.js";
export type { DepthKind } from "./input/depth-kind.js";
export type { EncodedBytes } from "./input/types.js";
export type { SceneFiles } from "./scene/scene-files.js";
export type { SceneInput, SceneObjectInput } from "./scene/types.js";
export type { Sim3 } from "./sim3.js";

/**
 * Reads a scene folder: a depth map and, optionally, a camera and a photo, as in a case folder; and
 * `objects/NAME/` with `mask.*`, `mesh.*` and, optionally, `initial.json` (a pose to start from) and `gt.json`.
 * @param files by path, relative to the folder
 *
 * @example
 * const { input, truths } = await readScene({ "depth.png": depth, "objects/mug/mask.png": mask, "objects/mug/mesh.glb": mesh });
 * const result = await aligner.alignScene(input);
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names
 */
export async function readScene(files: CaseFiles, settings: CaseSettings = {}): Promise<SceneFiles> {
  return sceneFrom(ownFiles(files), ownSettings(settings), () => formatsModule.load());
}

/**
 * Reads an output of SAM 3D Objects as a scene: `pointmap.npy` (or a `.npz` of MoGe, or a depth map), the photo, and for each
 * object its mask, its GLB or the PLY of its Gaussians, and `pose.json` with `rotation` (w, x, y, z), `translation` and
 * `scale`, in `objects/NAME/` or with NAME in their names. Its frames are converted. Where it put an object is the object's
 * `initial`: one candidate among those of the search. The depth of its point maps is `"scale-invariant"`, unless `depthKind`
 * says otherwise.
 * @param files by path, relative to the folder
 *
 * @example
 * const { input } = await readSam3d({ "pointmap.npy": points, "0.png": mask, "0.glb": mesh, "0.json": pose });
 * const result = await aligner.alignScene(input);
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` for an object without mask or mesh, `CORRUPT_FILE`, and the errors of
 * `fromSam3d` with the name of the file
 */
export async function readSam3d(files: CaseFiles, settings: CaseSettings = {}): Promise<SceneFiles> {
  return sam3dFrom(ownFiles(files), ownSettings(settings), () => formatsModule.load());
}

const ownSettings = (settings: CaseSettings) => withoutUndefined(ownOptions(settings));
