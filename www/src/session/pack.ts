/** A session as plain data: the files of a scene, and what was done with its objects. */
import type { DepthCalibration, DepthKind, Support } from "sim3align";
import { toSim3 } from "sim3align/conventions/similarity";
import { baseName } from "../input/files.js";
import { inCalibration } from "../state/calibration.js";
import type { CameraSource, Inputs, MaskSource, MeshSource, NamedFile, Role } from "../state/inputs.js";
import { doubtOf } from "../state/object-model.js";
import { applyToObject, type ObjectWork, stateOf, verdictOf } from "../state/object-work.js";
import type { Options } from "../state/options.js";
import { isResult } from "../state/pose.js";
import { type Judged, type Progress, progressOf, progressOfFrames } from "../state/progress.js";
import type { Scene } from "../state/scene.js";
import type { FramePose, VideoWork } from "../state/video.js";
import type { Workspace } from "../state/workspace.js";

/** The version of the format. Other versions are not read. */
const VERSION = 2;

/** The name of the session in a file. */
export const SESSION_FILE = "sim3align-session.json";

/** A file by its index. */
type Ref = number;

interface PackedObject {
  name: string;
  mask: (Omit<MaskSource, "file"> & { file: Ref }) | null;
  mesh: Ref | null;
  truth: { file: Ref } | null;
  initial?: Ref;
  /** Null if the scene was not opened yet. */
  state: ObjectWork | null;
}

/** A frame of a video: its tracked pose, and what a person has done in it. */
interface PackedFrame extends PackedInputs {
  tracked: (Omit<FramePose, "transform"> & { matrix: readonly number[] }) | null;
  work: ObjectWork | null;
}

/** The inputs of a scene. */
interface PackedInputs {
  name: string;
  depth: Ref | null;
  depthScale: number | null;
  depthKind: DepthKind | null;
  photo: Ref | null;
  camera: Exclude<CameraSource, { kind: "file" }> | { kind: "file"; file: Ref } | null;
  imageId: string | null;
  resizeMasks: boolean;
  objects: PackedObject[];
  roles: { file: Ref; role: Role }[];
}

/** A session without its files. */
export interface Packed extends PackedInputs {
  version: number;
  /** In whose depth the poses are. */
  calibration: DepthCalibration | null;
  options: Options;
  /** The ground, if an alignment has found it. */
  support?: Support | null;
  /** Those of a video, and the index of the one that was shown last. */
  frames?: PackedFrame[];
  frameIndex?: number;
}

/** What counts for a whole scene. */
export type Settings = Pick<Packed, "options" | "support">;

/** The session of a scene or a video, and its files in the order of their indices. */
export function packed(
  inputs: Inputs,
  done: Scene | VideoWork | null,
  settings: Settings,
): { session: Packed; files: NamedFile[] } {
  const files = new Map<NamedFile, Ref>();
  const scene = done !== null && "objects" in done ? done : null;
  const work = done !== null && "framePoses" in done ? done : null;
  const session: Packed = {
    ...packedInputs(inputs, scene, files),
    ...{ version: VERSION, calibration: scene?.calibration ?? null, ...settings },
  };
  if (inputs.frames !== undefined) {
    session.frameIndex = work?.frameIndex ?? 0;
    session.frames = inputs.frames.map((frame, i) => {
      const { transform, ...rest } = work?.framePoses[i] ?? {};
      const tracked = transform && ({ ...rest, matrix: [...transform.matrix] } as PackedFrame["tracked"]);
      return { ...packedInputs(frame, null, files), tracked: tracked ?? null, work: work?.frameWorks[i] ?? null };
    });
  }
  return { session, files: [...files.keys()] };
}

/** Inputs by the indices of their files, to which those of theirs are added. */
function packedInputs(inputs: Inputs, scene: Scene | null, files: Map<NamedFile, Ref>): PackedInputs {
  const ref = (file: NamedFile): Ref => {
    const known = files.get(file) ?? files.size;
    files.set(file, known);
    return known;
  };
  const optional = (file: NamedFile | null): Ref | null => (file === null ? null : ref(file));
  const { camera, depthScale, depthKind, imageId, name, resizeMasks } = inputs;
  const objects = inputs.objects.map(({ name, mask, mesh, truth, initial }, i): PackedObject => {
    for (const sibling of mesh?.siblings ?? []) if (isResource(sibling.path)) ref(sibling);
    const object = scene?.objects[i];
    return {
      name: object?.name ?? name,
      mask: mask && { ...mask, file: ref(mask.file) },
      mesh: mesh && ref(mesh.file),
      truth: truth && { file: ref(truth) },
      ...(initial && { initial: ref(initial) }),
      state: object === undefined ? null : stateOf(object),
    };
  });
  return {
    ...{ name, depthScale, depthKind, imageId, resizeMasks, objects },
    depth: optional(inputs.depth),
    photo: optional(inputs.photo),
    camera: camera?.kind === "file" ? { ...camera, file: ref(camera.file) } : camera,
    roles: inputs.files.flatMap(({ file, role }) =>
      // The cameras of a video are where these files say.
      role === "pose" || files.has(file) ? [{ file: ref(file), role }] : [],
    ),
  };
}

/** Files that meshes refer to. */
const isResource = (path: string) => /\.(bin|mtl|png|jpe?g|webp)$/i.test(baseName(path));

/** How far the work of a session is; null if it has not begun. */
export function progressOfPacked({ frames, objects }: Packed): Progress | null {
  if (frames !== undefined) {
    const verdicts = frames.map(({ work }) => verdictOf(work));
    return progressOfFrames(frames.map(framePose), verdicts);
  }
  if (objects.every(({ state }) => state === null)) return null;
  return progressOf(
    objects.map(({ state }): Judged => {
      const { source = "start", alignment = null } = state ?? {};
      const found = isResult(source) && alignment !== null && "confidence" in alignment ? alignment.confidence : null;
      const doubt = isResult(source) ? doubtOf(alignment) : null;
      return { isPlaced: source !== "start", verdict: verdictOf(state), confidence: found, doubt };
    }),
  );
}

function framePose({ tracked }: PackedFrame): FramePose | null {
  if (tracked === null) return null;
  const { matrix, ...pose } = tracked;
  return { ...pose, transform: toSim3(matrix) };
}

/** What was done in the video of a session. */
export const videoWorkOf = ({ frames = [], frameIndex = 0 }: Packed): VideoWork => ({
  ...{ frameIndex, framePoses: frames.map(framePose), frameWorks: frames.map(({ work }) => work) },
});

/** Whether a mask is one value of a label map, or one annotation of a COCO file, as version 1.0.0 could read them. */
const isPartOfFile = ({ mask }: PackedObject) => mask !== null && ("label" in mask || "annotation" in mask);

/** The inputs of a session; null for one of another version. */
export function unpacked(session: Packed, files: readonly NamedFile[], id = ""): Inputs | null {
  if (session.version !== VERSION || session.objects.some(isPartOfFile)) return null;
  const meshes = new Map<Ref, MeshSource>();
  const inputs = unpackedInputs(session, files, id, meshes);
  return session.frames === undefined
    ? inputs
    : { ...inputs, frames: session.frames.map((frame) => unpackedInputs(frame, files, id, meshes)) };
}

/** Objects with the same mesh file share what refers to it, in all frames of a video. */
function unpackedInputs(
  packed: PackedInputs,
  files: readonly NamedFile[],
  id: string,
  meshes: Map<Ref, MeshSource>,
): Inputs {
  const at = (ref: Ref): NamedFile => files[ref] as NamedFile;
  const optional = (ref: Ref | null) => (ref === null ? null : at(ref));
  const { camera, depthScale, depthKind = null, imageId, name, resizeMasks } = packed;
  const meshOf = (ref: Ref): MeshSource => {
    const mesh = meshes.get(ref) ?? { file: at(ref), siblings: files };
    meshes.set(ref, mesh);
    return mesh;
  };
  const objects = packed.objects.map(({ name, mask, mesh, truth, initial }) => ({
    name,
    mask: mask && { ...mask, file: at(mask.file) },
    mesh: mesh === null ? null : meshOf(mesh),
    truth: truth && at(truth.file),
    ...(initial !== undefined && { initial: at(initial) }),
  }));
  return {
    ...{ id, name, sample: null, depthScale, depthKind, imageId, resizeMasks, objects },
    depth: optional(packed.depth),
    photo: optional(packed.photo),
    camera: camera?.kind === "file" ? { ...camera, file: at(camera.file) } : camera,
    meshes: [...new Set(objects.flatMap(({ mesh }) => mesh ?? []))],
    files: packed.roles.map(({ file, role }) => ({ file: at(file), role })),
  };
}

/** What a session says of a scene that is there. */
interface SessionState {
  objects: readonly { state: ObjectWork | null }[];
  options: Partial<Options>;
  calibration?: DepthCalibration | null | undefined;
  support?: Support | null | undefined;
}

/** Gives the objects of the scene that is shown the poses and settings of a session. */
export function applyState(session: SessionState, workspace: Workspace): void {
  const { objects, options: chosen, calibration, support: ground = null } = session;
  const { options, recalibrate, scene, support } = workspace;
  const whole = scene.peek();
  if (whole === null) return;
  options.value = { ...options.peek(), ...chosen };
  if (calibration) recalibrate(inCalibration(whole, calibration));
  support.value = ground;
  whole.objects.forEach((object, i) => {
    const state = objects[i]?.state;
    if (state != null) applyToObject(state, object);
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
