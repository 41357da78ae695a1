/** Files of a whole scene: GLB, and the formats of simulators. */
import { mkdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import type { Command } from "commander";
import { exportSceneGlb, type SceneGlbObject } from "../conventions/scene-glb.js";
import { parseCameraFile } from "../formats/camera-file.js";
import type { SceneInput, SceneResult } from "../index.js";
import { readMesh } from "../input/mesh.js";
import type { MeshArrays } from "../input/types.js";
import { fileReaders } from "../modules/readers.js";
import type { SceneOnDisk } from "../scene-folder.js";
import { toMjcf } from "../simulators/mjcf.js";
import { SIMULATOR_DEFAULTS, type SimulatorObject, type SimulatorScene, simulatorScene } from "../simulators/scene.js";
import { toUrdf } from "../simulators/urdf.js";
import { toUsd } from "../simulators/usd.js";
import { withoutUndefined } from "../values/values.js";
import { type ExportedAs, exportedArrays, exportedMesh } from "./exported-mesh.js";
import { number } from "./parse.js";
import { fixed } from "./table.js";
import { UsageError } from "./usage-error.js";
import { checkWritable, makeFolder } from "./writable.js";

/** Values of the flags. */
export interface SceneFileFlags {
  sceneGlb?: string;
  mjcf?: string;
  urdf?: string;
  usd?: string;
  density?: number;
  parts?: number;
  rest?: boolean;
  upright?: boolean;
}

/** Adds the flags to a command. */
export const addSceneFileFlags = (command: Command): Command =>
  command
    .option("--scene-glb <file>", "write the scene as one GLB file")
    .option("--mjcf <folder>", "write the scene for MuJoCo: scene.xml and meshes")
    .option("--urdf <folder>", "write the scene as URDF: a file per object, scene.json, load.py for PyBullet")
    .option("--usd <file>", "write the scene as USD with physics (.usda)")
    .option("--density <kg/m³>", `mass per volume for simulators (default ${SIMULATOR_DEFAULTS.density})`, number)
    .option(
      "--parts <n>",
      `most convex parts of an object for simulators; 1 is its hull (default ${SIMULATOR_DEFAULTS.maxParts})`,
      number,
    )
    .option("--no-rest", "keep all objects for simulators where they were found: they are not put at rest");

/**
 * Checks the flags before the first scene.
 * @param isMetric whether lengths will be metric, as simulators need them
 * @throws {@link UsageError}
 */
export function checkSceneFiles(
  { sceneGlb, mjcf, urdf, usd }: SceneFileFlags,
  scenes: number,
  isMetric: boolean,
): void {
  const outputs = [
    ["--scene-glb", sceneGlb, checkWritable, false],
    ["--mjcf", mjcf, makeFolder, true],
    ["--urdf", urdf, makeFolder, true],
    ["--usd", usd, checkWritable, true],
  ] as const;
  for (const [flag, path, check, needsMetres] of outputs) {
    if (path === undefined) continue;
    if (needsMetres && !isMetric)
      throw new UsageError(
        `${flag} needs metres, which depth of this kind has not: pass --known-extent, or a number as --scale; or --depth-kind metric, if it is in metres.`,
      );
    if (scenes > 1) throw new UsageError(`${flag} takes a single scene.`);
    check(flag, path);
  }
}

/** Writes the files. Returns lines that say which bodies are fixed, and how far others were moved. */
export async function writeSceneFiles(
  scene: SceneOnDisk,
  result: SceneResult,
  flags: SceneFileFlags,
): Promise<string[]> {
  const { sceneGlb, mjcf, urdf, usd, density, parts, rest, upright } = flags;
  const camera = cameraOf(scene.input, result);
  if (sceneGlb !== undefined) writeFileSync(sceneGlb, await glbOf(scene, result, camera, upright));
  if (mjcf === undefined && urdf === undefined && usd === undefined) return [];
  const { support } = result;
  const options = { support, ...withoutUndefined({ camera, density, maxParts: parts, rest }) };
  const simulated = await simulatorScene(await simulatorObjects(scene, result, upright), options);
  if (mjcf !== undefined) writeTexts(mjcf, toMjcf(simulated));
  if (urdf !== undefined) writeTexts(urdf, toUrdf(simulated));
  if (usd !== undefined) writeFileSync(usd, toUsd(simulated));
  return linesOf(simulated);
}

function linesOf({ bodies, supportHeightM }: SimulatorScene): string[] {
  const ground = `ground: ${fixed(-1000 * supportHeightM, 1)} mm above the support, where most objects stand`;
  const lines = bodies.map(({ name, isFixed, mass, movedM, turnedDeg, parts }) => {
    const state = isFixed
      ? "fixed"
      : movedM === 0 && turnedDeg === 0
        ? "free, where it was found"
        : `free, moved ${fixed(1000 * movedM, 1)} mm and turned ${fixed(turnedDeg, 1)}° to rest`;
    return `${name}: ${fixed(mass, 3)} kg, ${parts.length} convex parts, ${state}`;
  });
  return supportHeightM === 0 ? lines : [ground, ...lines];
}

function writeTexts(folder: string, files: Record<string, string>): void {
  for (const [path, text] of Object.entries(files)) {
    const file = join(folder, path);
    mkdirSync(dirname(file), { recursive: true });
    writeFileSync(file, text);
  }
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
    const given = input.objects[i]?.mesh;
    if (object.error !== undefined || given === undefined) continue;
    const { mesh } = await readMesh(given, fileReaders, true);
    const { restsOn } = object.contact;
    const on = typeof restsOn === "number" ? (places.get(restsOn) ?? null) : restsOn;
    const as = exportedAs(object.proportions, support, upright, "z");
    found.push({ name: object.name, ...exportedArrays(mesh as MeshArrays, object, as), restsOn: on });
  }
  return found;
}

const exportedAs = (
  proportions: ExportedAs["proportions"],
  support: SceneResult["support"],
  isUpright: boolean | undefined,
  up: "y" | "z",
): ExportedAs => ({ proportions, upright: isUpright ? { support, up } : undefined });

interface ImageCamera {
  fy: number;
  width: number;
  height: number;
}

/** The scene as one file. Only GLB files keep their materials. */
async function glbOf(
  { input }: SceneOnDisk,
  { objects, support }: SceneResult,
  camera: ImageCamera | undefined,
  upright: boolean | undefined,
): Promise<Uint8Array> {
  const placed: SceneGlbObject[] = [];
  for (const [i, object] of objects.entries()) {
    const given = input.objects[i]?.mesh;
    if (object.error !== undefined || given === undefined) continue;
    const as = exportedAs(object.proportions, support, upright, "y");
    placed.push({ name: object.name, ...(await exportedMesh(given, object, as)) });
  }
  return exportSceneGlb(placed, { support, ...(camera === undefined ? {} : { camera }) });
}

function cameraOf(input: SceneInput, { depthCalibration }: SceneResult): ImageCamera | undefined {
  const { cameraFile, imageId } = input as { cameraFile?: Uint8Array; imageId?: string };
  const found = depthCalibration?.camera;
  // The principal point of a camera that was not given is the centre.
  if (cameraFile === undefined) return found && { fy: found.fy, width: 2 * found.cx + 1, height: 2 * found.cy + 1 };
  try {
    const { fy, cx, cy, width, height } = parseCameraFile(cameraFile, withoutUndefined({ imageId }));
    // A file without size: the principal point is about the middle.
    return { fy, width: width ?? 2 * cx + 1, height: height ?? 2 * cy + 1 };
  } catch {
    return undefined;
  }
}
