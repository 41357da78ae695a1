/** Scenes that a host sets on the element: as arrays or encoded files in memory, as files, or by an address. */
import type { EncodedBytes } from "sim3align";
import type { MeshFromFile } from "sim3align/formats";
import { DEFAULT_SCALE } from "sim3align/input/depth";
import { readMesh as meshFrom } from "sim3align/input/mesh";
import type { CoreView } from "sim3align/modules/core-input";
import { fileReaders } from "sim3align/modules/readers";
import { readScene } from "sim3align/scene/read-scene";
import { failure } from "sim3align/values/error";
import { isRecord } from "sim3align/values/kinds";
import { viewOf } from "../input/depth-view.js";
import { photoFrom } from "../input/photo.js";
import { readMesh, shownGlb } from "../input/reader.js";
import { type ReadObject, sceneOf } from "../input/reading.js";
import { type Inputs, noInputs } from "../state/inputs.js";
import type { Opened } from "./given-files.js";
import type { GivenInput, GivenScene } from "./sim3-align.js";

/** Reads a scene. What files and addresses need is loaded with the first of them. */
export async function readGiven(given: GivenInput): Promise<Opened> {
  const isFiles = typeof given === "string" || given instanceof Blob || Array.isArray(given);
  return isFiles ? (await import("./given-files.js")).readFiles(given) : fromMemory(given as GivenScene);
}

/** A scene in memory, read as `alignScene` reads it. */
async function fromMemory({ name = "Scene", image, ...given }: GivenScene): Promise<Opened> {
  // Pixels state no focal length, and a photo is shown at the size of the depth map.
  const hint = image instanceof Blob && given.camera === undefined ? { image } : {};
  const read = await readScene({ ...given, ...hint } as Parameters<typeof readScene>[0], fileReaders);
  const { view, notes } = read;
  const [width, height] = read.size;
  const { camera, focalDeviation = 0, depthKind = "metric" } = view;
  const data = depthValues(view);
  if (camera === undefined || width * height !== data.length) {
    const found = `${data.length} values`;
    throw failure("WRONG_LENGTH", "depth", found, `width × height, ${width} × ${height}`, "Pass one per pixel.");
  }
  const [photo, objects] = await Promise.all([
    image === undefined ? null : photoFrom(image, { width, height }),
    Promise.all(read.objects.map(async ({ mask, mesh }) => ({ mask, ...(await meshOf(mesh)), truth: null }))),
  ]);
  const names = read.objects.map(({ name }, i) => name ?? (objects.length === 1 ? "Object" : `Object ${i + 1}`));
  const inputs: Inputs = {
    ...noInputs,
    name,
    objects: names.map((name) => ({ name, mask: null, mesh: null, truth: null })),
  };
  const cameraSource = notes.cameraSource ?? null;
  const warnings = notes.warnings.map(({ message }) => message);
  const calibrated = { camera, source: cameraSource, focalUncertainty: focalDeviation, warnings };
  const { depthM, raw } = viewOf({ data, width, height, depthKind }, calibrated);
  const scene = sceneOf(inputs, {
    ...{ depth: { data: depthM, width, height }, raw, depthUnit: notes.depthUnit ?? null, photo, objects },
    ...{ camera, cameraSource, warnings },
  });
  if (scene === null) {
    const expected = "a mask and a mesh per object";
    throw failure("INVALID_ARGUMENT", "objects", "an object without one", expected, "Pass [{ mask, mesh }, …].");
  }
  return { scene, inputs, session: null };
}

/** The values of a depth map: metres, or the values themselves where they have no unit. */
function depthValues({ depth = new Float32Array(), depthScale }: CoreView): Float32Array {
  const scale = Number(depthScale) || (depth instanceof Float32Array ? 1 : DEFAULT_SCALE);
  return Float32Array.from(depth, (value) => value * scale);
}

async function meshOf(mesh: unknown): Promise<Pick<ReadObject, "mesh" | "glb">> {
  const isEncoded = mesh instanceof Uint8Array || mesh instanceof ArrayBuffer || mesh instanceof Blob;
  if (!isEncoded) {
    // The reader of `align` names what is wrong.
    const { mesh: read } = await meshFrom(mesh, fileReaders, true);
    return { mesh: (isRecord(mesh) && "positions" in mesh ? mesh : read) as MeshFromFile, glb: null };
  }
  const bytes = await bytesOf(mesh);
  return { mesh: await readMesh(bytes), glb: shownGlb(bytes) };
}

const bytesOf = async (source: EncodedBytes): Promise<Uint8Array> =>
  source instanceof Uint8Array ? source : new Uint8Array("arrayBuffer" in source ? await source.arrayBuffer() : source);
