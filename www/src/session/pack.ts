/** A session as plain data: the files of a scene, and what was done with its objects. */
import type { DepthCalibration, DepthKind } from "sim3align";
import { toSim3 } from "sim3align/conventions";
import { baseName, type NamedFile } from "../load/files.js";
import type { CameraSource, Inputs, MaskSource, MeshSource, Role, TruthSource } from "../load/inputs.js";
import type { AnyAlignment } from "../state/alignment.js";
import { inCalibration } from "../state/calibration.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Options } from "../state/options.js";
import { isResult, type PoseSource } from "../state/pose.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";

/** The version of the format. Other versions are not read. */
const VERSION = 1;

/** The name of the session in a file. */
export const SESSION_FILE = "sim3align-session.json";

/** A file by its index. */
type Ref = number;

interface PackedObject {
  name: string;
  mask: (Omit<MaskSource, "file"> & { file: Ref }) | null;
  mesh: Ref | null;
  truth: (Omit<TruthSource, "file"> & { file: Ref }) | null;
  initial?: Ref;
  /** Null if the scene was not opened yet. */
  state: PackedState | null;
}

/** What was done with an object. */
export interface PackedState {
  matrix: readonly number[];
  source: PoseSource;
  alternative?: number | undefined;
  isAccepted: boolean;
  isShown: boolean;
  isLocked: boolean;
  knownScale: number | null;
  alignment: AnyAlignment | null;
}

/** A session without its files. */
export interface Packed {
  version: number;
  name: string;
  depth: Ref | null;
  depthScale: number | null;
  depthKind: DepthKind | null;
  /** In whose depth the poses are. */
  calibration: DepthCalibration | null;
  photo: Ref | null;
  camera: Exclude<CameraSource, { kind: "file" }> | { kind: "file"; file: Ref } | null;
  imageId: string | null;
  resizeMasks: boolean;
  objects: PackedObject[];
  roles: { file: Ref; role: Role }[];
  options: Options;
}

/** The session of a scene, and its files in the order of their indices. */
export function packed(inputs: Inputs, scene: Scene | null, options: Options): { session: Packed; files: NamedFile[] } {
  const files: NamedFile[] = [];
  const ref = (file: NamedFile): Ref => {
    const known = files.indexOf(file);
    return known >= 0 ? known : files.push(file) - 1;
  };
  const optional = (file: NamedFile | null): Ref | null => (file === null ? null : ref(file));
  const { camera, depthScale, depthKind, imageId, name, resizeMasks } = inputs;
  const calibration = scene?.calibration ?? null;
  const objects = inputs.objects.map(({ name, mask, mesh, truth, initial }, i): PackedObject => {
    for (const sibling of mesh?.siblings ?? []) if (isResource(sibling.path)) ref(sibling);
    const object = scene?.objects[i];
    return {
      name: object?.name ?? name,
      mask: mask && { ...mask, file: ref(mask.file) },
      mesh: mesh && ref(mesh.file),
      truth: truth && { ...truth, file: ref(truth.file) },
      ...(initial && { initial: ref(initial) }),
      state: object === undefined ? null : stateOf(object),
    };
  });
  const session: Packed = {
    ...{
      version: VERSION,
      name,
      depthScale,
      depthKind,
      calibration,
      imageId,
      resizeMasks,
      objects,
      roles: [],
      options,
    },
    depth: optional(inputs.depth),
    photo: optional(inputs.photo),
    camera: camera?.kind === "file" ? { ...camera, file: ref(camera.file) } : camera,
  };
  session.roles = inputs.files.flatMap(({ file, role }) => (files.includes(file) ? [{ file: ref(file), role }] : []));
  return { session, files };
}

/** Files that meshes refer to. */
const isResource = (path: string) => /\.(bin|mtl|png|jpe?g|webp)$/i.test(baseName(path));

/** What was done with an object. */
export function stateOf({ pose, isAccepted, isShown, isLocked, knownScale, alignment }: ObjectModel): PackedState {
  const { transform, source, alternative } = pose.value;
  return {
    ...{ matrix: [...transform.matrix], source, alternative },
    ...{ isAccepted: isAccepted.value, isShown: isShown.value, isLocked: isLocked.value },
    ...{ knownScale: knownScale.value, alignment: alignment.value },
  };
}

/** What counts of an object for the progress of its scene. */
export function judged(state: PackedState | null) {
  const { source = "start", isAccepted = false, alignment = null } = state ?? {};
  const confidence = isResult(source) && alignment !== null && "confidence" in alignment ? alignment.confidence : null;
  return { isPlaced: source !== "start", isAccepted, confidence };
}

/** The inputs of a session; null for one of another version. */
export function unpacked(session: Packed, files: readonly NamedFile[], id = ""): Inputs | null {
  if (session.version !== VERSION) return null;
  const at = (ref: Ref): NamedFile => files[ref] as NamedFile;
  const optional = (ref: Ref | null) => (ref === null ? null : at(ref));
  const { camera, depthScale, depthKind = null, imageId, name, resizeMasks } = session;
  const meshes = new Map<Ref, MeshSource>();
  for (const { mesh } of session.objects) if (mesh !== null) meshes.set(mesh, { file: at(mesh), siblings: files });
  return {
    ...{ id, name, sample: null, depthScale, depthKind, imageId, resizeMasks },
    depth: optional(session.depth),
    photo: optional(session.photo),
    camera: camera?.kind === "file" ? { ...camera, file: at(camera.file) } : camera,
    objects: session.objects.map(({ name, mask, mesh, truth, initial }) => ({
      name,
      mask: mask && { ...mask, file: at(mask.file) },
      mesh: mesh === null ? null : (meshes.get(mesh) ?? null),
      truth: truth && { ...truth, file: at(truth.file) },
      ...(initial !== undefined && { initial: at(initial) }),
      isSure: true,
    })),
    meshes: [...meshes.values()],
    files: session.roles.map(({ file, role }) => ({ file: at(file), role })),
  };
}

/** What a session says of a scene that is there. */
interface SessionState {
  objects: readonly { state: PackedState | null }[];
  options: Partial<Options>;
  calibration?: DepthCalibration | null | undefined;
}

/** Gives the objects of the scene that is shown the poses and settings of a session. */
export function applyState({ objects, options: chosen, calibration }: SessionState, workspace: Workspace): void {
  const { options, recalibrate, scene } = workspace;
  const whole = scene.peek();
  if (whole === null) return;
  options.value = { ...options.peek(), ...chosen };
  if (calibration) recalibrate(inCalibration(whole, calibration));
  whole.objects.forEach((object, i) => {
    const state = objects[i]?.state;
    if (state == null) return;
    const { matrix, source, alternative, alignment } = state;
    object.run.value = { state: alignment === null ? "idle" : "done" };
    const pose = { transform: toSim3(matrix), source, alignment, ...(alternative !== undefined && { alternative }) };
    object.pose.value = pose;
    object.accepted.value = state.isAccepted ? pose : null;
    object.isShown.value = state.isShown;
    object.isLocked.value = state.isLocked;
    object.knownScale.value = state.knownScale;
  });
}

/** Whether a file of an archive is a session. */
export const isSession = ({ path }: Pick<NamedFile, "path">): boolean =>
  path === SESSION_FILE || path.endsWith(`/${SESSION_FILE}`);

/** A session in the files of an archive, and those in its folder that it refers to. */
export async function sessionParts<S extends Packed>(
  files: readonly NamedFile[],
  own: NamedFile,
): Promise<{ session: S; files: NamedFile[] }> {
  const folder = own.path.slice(0, -SESSION_FILE.length);
  const session = JSON.parse(new TextDecoder().decode(await own.bytes())) as S;
  const rest: NamedFile[] = [];
  for (const { path, bytes } of files) {
    const [, index, name] = (path.startsWith(folder) && /^(\d+)\/(.*)$/.exec(path.slice(folder.length))) || [];
    if (index !== undefined && name !== undefined) rest[Number(index)] = { path: name, bytes };
  }
  return { session, files: rest };
}
