/** Inputs and meshes in the lengths of a result; files of posed meshes, of scenes, and of scenes for simulators. */

import { join } from "node:path";
import { toOrigin } from "../calls/origin.js";
import { correctDepth } from "../conventions/depth.js";
import type { SceneCamera } from "../conventions/scene-frame.js";
import { exportSceneGlb, type SceneGlbObject } from "../conventions/scene-glb.js";
import { stretchMesh } from "../conventions/stretch.js";
import { type UprightOptions, uprightMesh } from "../conventions/upright.js";
import type { Stretch } from "../generated/types.js";
import type { AlignInput, DepthCalibration, SceneInput, SceneResult } from "../index.js";
import { readMesh } from "../input/mesh.js";
import { resolveView } from "../input/resolve.js";
import { fileReaders } from "../modules/readers.js";
import type { SceneOnDisk } from "../scene-folder.js";
import { toMjcf } from "../simulators/mjcf.js";
import { type SimulatorBody, type SimulatorObject, type SimulatorScene, simulatorScene } from "../simulators/scene.js";
import { toUrdf } from "../simulators/urdf.js";
import { toUsd } from "../simulators/usd.js";
import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays, MeshInput } from "../types/inputs.js";
import { isRecord } from "../values/kinds.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import { withoutUndefined } from "../values/validation.js";
import type { Flags } from "./flags.js";
import { fixed } from "./row.js";
import { isExport, type RunFiles } from "./run-files.js";

/** An input in the lengths of a result. Results without a calibration leave the depth as it is. */
export async function correctedInput(
  input: AlignInput,
  calibration: DepthCalibration | undefined,
): Promise<AlignInput> {
  if (calibration === undefined) return input;
  const { image, mask, mesh, resizeMask, maskIndex } = input;
  // The photo is not needed to read the depth.
  const { core: view } = await resolveView({ ...input, image: undefined }, fileReaders);
  const depthMap = { data: view.depth as Float32Array, width: Number(view.width), height: Number(view.height) };
  const depth = correctDepth(depthMap, calibration);
  return { depth, camera: calibration.camera, mask, mesh, image, resizeMask, maskIndex };
}

/** A mesh for a file, with its transform. */
export interface ExportedMesh<M> {
  mesh: M;
  transform: Sim3Like;
}

/** Options of the export of an object. */
export interface ExportedAs {
  /** The `proportions` of its result, if these were asked for. */
  proportions: Pick<Stretch, "matrix" | "stretch"> | undefined;
  /** The upright frame, if it is requested. */
  upright: UprightOptions | undefined;
}

/** Arrays, for an export. `pose` is the result, whose facts are kept. */
function exportedArrays<M extends MeshArrays>(
  mesh: M,
  pose: Sim3Like,
  { proportions, upright }: ExportedAs,
): ExportedMesh<M> {
  // The result is of the mesh in its file.
  const { fileOrigin } = mesh as Pick<CoreMesh, "fileOrigin">;
  const own = inProportion(mesh, toOrigin(pose, fileOrigin), toOrigin(proportions, fileOrigin));
  const straight = upright === undefined ? own : uprightMesh(own.mesh, own.transform, upright);
  return { mesh: straight.mesh, transform: withFacts(straight.transform, pose) };
}

/** The file of a GLB, whose materials are kept, or the arrays of another mesh, for an export. */
export async function exportedMesh(
  input: MeshInput,
  pose: Sim3Like,
  as: ExportedAs,
): Promise<ExportedMesh<Uint8Array | MeshArrays>> {
  const { bytes, format } = (isRecord(input) ? input : {}) as { bytes?: Uint8Array; format?: string };
  const read = async () => (await readMesh(input, fileReaders, false)).mesh as MeshArrays;
  if (format !== "glb" || bytes === undefined) return exportedArrays(await read(), pose, as);
  const { proportions, upright } = as;
  const glb = proportions === undefined ? bytes : stretchMesh(bytes, proportions);
  if (upright === undefined) return { mesh: glb, transform: withFacts(proportions ?? pose, pose) };
  const arrays = await read();
  if ("fileOrigin" in arrays) return exportedArrays(arrays, pose, as);
  const stretched = inProportion(arrays, pose, proportions);
  const straight = uprightMesh(stretched.mesh, stretched.transform, { ...upright, glb });
  return { mesh: straight.mesh, transform: withFacts(straight.transform, pose) };
}

const inProportion = <M extends MeshArrays>(mesh: M, pose: Sim3Like, proportions: ExportedAs["proportions"]) =>
  proportions === undefined
    ? { mesh, transform: pose }
    : { mesh: stretchMesh(mesh, proportions), transform: proportions as Sim3Like };

/** Another transform of an object, with the metrics and the confidence of its result. */
function withFacts(transform: Sim3Like, result: Sim3Like): Sim3Like {
  if (transform === result || !isRecord(result) || !isRecord(transform)) return transform;
  const { metrics, confidence } = result as Record<string, unknown>;
  return { ...transform, ...withoutUndefined({ metrics, confidence }) } as Sim3Like;
}

/** Writes the files. Returns lines that say which bodies are fixed, and how far others were moved. */
export async function writeSceneFiles(
  scene: SceneOnDisk,
  result: SceneResult,
  flags: Flags,
  files: RunFiles,
): Promise<string[]> {
  const { sceneGlb, mjcf, urdf, usd, density, parts, rest, upright } = flags;
  if ([sceneGlb, mjcf, urdf, usd].every((path) => path === undefined)) return [];
  const camera = await cameraOf(scene.input, result);
  if (sceneGlb !== undefined)
    files.write({ flag: "--scene-glb", path: sceneGlb, isOwn: isExport }, await glbOf(scene, result, camera, upright));
  if (mjcf === undefined && urdf === undefined && usd === undefined) return [];
  const { support } = result;
  const options = { support, ...withoutUndefined({ camera, density, maxParts: parts, rest }) };
  const objects = await simulatorObjects(scene, result, upright);
  const simulated = await simulatorScene(objects, options);
  const writeAll = (flag: string, folder: string, texts: Record<string, string>) => {
    for (const [name, text] of Object.entries(texts))
      files.write({ flag, path: join(folder, name), isOwn: isExport }, text);
  };
  if (mjcf !== undefined) writeAll("--mjcf", mjcf, toMjcf(simulated));
  if (urdf !== undefined) writeAll("--urdf", urdf, toUrdf(simulated));
  if (usd !== undefined) files.write({ flag: "--usd", path: usd, isOwn: isExport }, toUsd(simulated));
  return linesOf(simulated, objects);
}

function linesOf({ bodies, hasGround, supportHeightM }: SimulatorScene, objects: readonly SimulatorObject[]): string[] {
  const side = supportHeightM > 0 ? "below" : "above";
  const ground = `ground: ${fixed(1000 * Math.abs(supportHeightM), 1)} mm ${side} the support, where most objects stand`;
  const motion = (moveM: number, turnDeg: number) => `${fixed(1000 * moveM, 1)} mm and turned ${fixed(turnDeg, 1)}°`;
  const whyFixed = ({ rest }: SimulatorBody, on: SimulatorObject["restsOn"]) => {
    if (rest !== null) return `rest needs it moved ${motion(rest.moveM, rest.turnDeg)}`;
    const isCarried = hasGround && (on === "support" || typeof on === "number");
    return isCarried ? "it would not stay at rest there" : "it rests on nothing in the scene";
  };
  const lines = bodies.map((body, i) => {
    const { name, isFixed, mass, movedM, turnedDeg, cutM, parts, wallsJoined } = body;
    const moved = movedM === 0 && turnedDeg === 0 ? "where it was found" : `moved ${motion(movedM, turnedDeg)} to rest`;
    const cut = cutM > 0 ? `, its parts cut by ${fixed(1000 * cutM, 1)} mm from below` : "";
    const fixedFor = () => `fixed where it was found, as ${whyFixed(body, objects[i]?.restsOn)}`;
    const state = isFixed ? fixedFor() : `free, ${moved}${cut}`;
    const count = `${parts.length} convex ${parts.length === 1 ? "part" : "parts"}`;
    const joined = wallsJoined === null ? "" : ` for ${wallsJoined} walls, so that openings are closed (--parts)`;
    return `${name}: ${fixed(mass, 3)} kg, ${count}${joined}, ${state}`;
  });
  return supportHeightM === 0 ? lines : [ground, ...lines];
}

/** The aligned objects with their meshes and colours. Indices of contacts count aligned objects only. */
async function simulatorObjects(
  { input }: SceneOnDisk,
  { objects, support }: SceneResult,
  upright: boolean | undefined,
): Promise<SimulatorObject[]> {
  const places = new Map<number, number>();
  for (const [i, object] of objects.entries()) if (object.error === undefined) places.set(i, places.size);
  const found: SimulatorObject[] = [];
  for (const [i, object] of objects.entries()) {
    const mesh = input.objects[i]?.mesh;
    if (object.error !== undefined || mesh === undefined) continue;
    const { mesh: arrays } = await readMesh(mesh, fileReaders, true);
    const { restsOn } = object.contact;
    const on = typeof restsOn === "number" ? (places.get(restsOn) ?? null) : restsOn;
    const as = exportedAs(object.proportions, support, upright, "z");
    found.push({ name: object.name, ...exportedArrays(arrays as MeshArrays, object, as), restsOn: on });
  }
  return found;
}

const exportedAs = (
  proportions: ExportedAs["proportions"],
  support: SceneResult["support"],
  isUpright: boolean | undefined,
  up: "y" | "z",
): ExportedAs => ({ proportions, upright: isUpright ? { support, up } : undefined });

/** The scene as one file. Only GLB files keep their materials. */
async function glbOf(
  { input }: SceneOnDisk,
  { objects, support }: SceneResult,
  camera: SceneCamera | undefined,
  upright: boolean | undefined,
): Promise<Uint8Array> {
  const placed: SceneGlbObject[] = [];
  for (const [i, object] of objects.entries()) {
    const mesh = input.objects[i]?.mesh;
    if (object.error !== undefined || mesh === undefined) continue;
    const as = exportedAs(object.proportions, support, upright, "y");
    placed.push({ name: object.name, ...(await exportedMesh(mesh, object, as)) });
  }
  return exportSceneGlb(placed, { support, ...(camera === undefined ? {} : { camera }) });
}

/** The camera that the scene was aligned with, and the size of its depth map. */
async function cameraOf(input: SceneInput, { depthCalibration }: SceneResult): Promise<SceneCamera | undefined> {
  const { objects: _, labels: __, occluders: ___, support: ____, image: _____, ...view } = input;
  const { core } = await resolveView(view, fileReaders);
  const { fx, fy, cx, cy } = depthCalibration?.camera ?? core.camera ?? {};
  if (fy === undefined) return undefined;
  return { fx, fy, cx, cy, width: Number(core.width), height: Number(core.height) };
}
