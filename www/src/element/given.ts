/** Scenes that a host gives to the element: as arrays or encoded files in memory, as files, or by an address. */
import type { EncodedBytes, PixelArray } from "sim3align";
import type { MeshFromFile } from "sim3align/formats";
import { cameraOf, knownCamera, type ReadDepthMap, viewOf } from "../input/depth-view.js";
import { atSize } from "../input/masks.js";
import { photoFrom } from "../input/photo.js";
import { type ReadObject, sceneOf } from "../input/read-scene.js";
import { readDepth, readMask, readMesh } from "../input/reader.js";

import { type Inputs, noInputs } from "../state/inputs.js";
import type { Opened } from "./given-files.js";
import type { GivenInput, GivenObject, GivenScene } from "./sim3-align.js";

/** Reads what a host gives. What files and addresses need is loaded with the first of them. */
export async function readGiven(given: GivenInput): Promise<Opened> {
  const isFiles = typeof given === "string" || given instanceof Blob || Array.isArray(given);
  return isFiles ? (await import("./given-files.js")).readFiles(given) : fromMemory(given as GivenScene);
}

/** A scene in memory, read as files are. */
async function fromMemory(given: GivenScene): Promise<Opened> {
  const read = await depthOf(given);
  const { width, height, unit: depthUnit } = read;
  const { camera: stated, image } = given;
  const [photo, objects] = await Promise.all([
    image === undefined ? null : photoFrom(image, { width, height }),
    Promise.all(given.objects.map((object) => objectOf(object, read))),
  ]);
  const bytes = image instanceof Blob ? await bytesOf(image) : null;
  const found =
    stated === undefined
      ? await cameraOf(read, photo && bytes && { ...photo, bytes })
      : await knownCamera(stated as object as Readonly<Record<string, unknown>>, { width, height });
  const { depthM, raw } = viewOf(read, found);
  const names = given.objects.map(({ name }, i) => name ?? (objects.length === 1 ? "Object" : `Object ${i + 1}`));
  const inputs: Inputs = {
    ...noInputs,
    name: given.name ?? "Scene",
    objects: names.map((name) => ({ name, mask: null, mesh: null, truth: null, isSure: true })),
  };
  const scene = sceneOf(inputs, {
    ...{ depth: { data: depthM, width, height }, raw, depthUnit, photo, objects },
    ...{ camera: found.camera, cameraSource: found.source, warnings: found.warnings },
  });
  if (scene === null) throw new Error("A scene has at least one object.");
  return { scene, inputs, session: null };
}

async function depthOf({
  depth,
  width = 0,
  height = 0,
  depthScale,
  depthKind = "metric",
}: GivenScene): Promise<ReadDepthMap> {
  if (!(depth instanceof Float32Array || depth instanceof Uint16Array)) {
    return { ...(await readDepth(depth, { depthScale, depthKind })), depthKind };
  }
  if (width * height !== depth.length) {
    throw new Error(`depth has ${depth.length} values; expected width × height, ${width} × ${height}.`);
  }
  const isMetric = depthKind === "metric";
  const isInteger = depth instanceof Uint16Array;
  const scale = depthScale ?? (isMetric && isInteger ? 0.001 : 1);
  const data = Float32Array.from(depth, (z) => z * scale);
  const assumed = isInteger ? "16-bit integers" : "float values";
  const unit = isMetric
    ? { metres: scale, source: depthScale === undefined ? assumed : "depthScale", isAssumed: depthScale === undefined }
    : { metres: null, source: depthKind, isAssumed: false };
  return { data, width, height, depthKind, unit };
}

async function objectOf(
  { mask, mesh }: GivenObject,
  { width, height }: Omit<PixelArray<unknown>, "data">,
): Promise<ReadObject> {
  const isPlain = ArrayBuffer.isView(mask) && mask.length === width * height;
  const own = isPlain
    ? { data: Uint8Array.from(mask), width, height }
    : isPixels(mask)
      ? mask
      : await readMask(mask as EncodedBytes);
  const isEncoded = mesh instanceof Uint8Array || mesh instanceof ArrayBuffer || mesh instanceof Blob;
  const bytes = isEncoded ? await bytesOf(mesh) : null;
  return {
    mask: atSize(own, width, height, false),
    mesh: bytes === null ? (mesh as MeshFromFile) : await readMesh(bytes),
    glb: bytes !== null && new TextDecoder().decode(bytes.subarray(0, 4)) === "glTF" ? bytes : null,
    truth: null,
  };
}

const isPixels = (mask: object): mask is PixelArray<Uint8Array> => "data" in mask && "width" in mask;

const bytesOf = async (source: EncodedBytes): Promise<Uint8Array> =>
  source instanceof Uint8Array ? source : new Uint8Array("arrayBuffer" in source ? await source.arrayBuffer() : source);
