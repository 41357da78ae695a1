/** Scenes that a host gives to the element: as arrays or encoded files in memory, as files, or by an address. */
import type { EncodedBytes, PixelArray } from "sim3align";
import { type MeshFromFile, readCamera } from "sim3align/formats";
import { rolesOf } from "../intake/roles.js";
import { scenesOfTyped } from "../intake/scenes.js";
import { extractArchives } from "../load/archives.js";
import { filesAt } from "../load/case-url.js";
import { fromFile, type NamedFile } from "../load/files.js";
import { type Inputs, noInputs } from "../load/inputs.js";
import { atSize } from "../load/masks.js";
import { photoFrom } from "../load/photo.js";
import { type ReadObject, readInputs, sceneOf } from "../load/read-scene.js";
import { readDepth, readMask, readMesh } from "../load/reader.js";
import { type Packed, sessionParts, unpacked } from "../session/pack.js";
import type { Scene } from "../state/scene.js";
import type { GivenInput, GivenObject, GivenScene } from "./sim3-align.js";

/** A scene that can be shown, and what was done with it before. */
export interface Opened {
  scene: Scene;
  inputs: Inputs;
  session: Packed | null;
}

/** Reads what a host gives. */
export async function readGiven(given: GivenInput): Promise<Opened> {
  if (typeof given === "string") return fromFiles(await filesAt(given));
  if (given instanceof Blob) return fromFiles([fromFile(asFile(given))]);
  if (Array.isArray(given)) return fromFiles(given.map((file: File) => fromFile(file)));
  return fromMemory(given as GivenScene);
}

const asFile = (blob: Blob) => (blob instanceof File ? blob : new File([blob], "case.zip"));

/** The first scene of files, which may be a session. */
async function fromFiles(files: readonly NamedFile[]): Promise<Opened> {
  const extracted = await extractArchives(files);
  const parts = await sessionParts(extracted);
  const inputs =
    parts === null
      ? (await scenesOfTyped(await rolesOf(extracted)))[0]
      : (unpacked(parts.session, parts.files) ?? undefined);
  if (inputs === undefined) throw new Error("The files contain no scene that this version can open.");
  const reading = await readInputs(inputs);
  const [problem] = reading.problems;
  if (problem !== undefined) throw new Error(`${problem.field}: ${problem.message}`);
  const scene = sceneOf(inputs, reading);
  if (scene === null) {
    throw new Error("The files lack a part: a scene has a depth map, a camera, and a mask and a mesh per object.");
  }
  return { scene, inputs, session: parts?.session ?? null };
}

/** A scene in memory, read as files are. */
async function fromMemory(given: GivenScene): Promise<Opened> {
  const depth = await depthOf(given);
  const { width, height } = depth;
  const [{ fx, fy, cx, cy }, photo, objects] = await Promise.all([
    readCamera(given.camera as object as Readonly<Record<string, unknown>>, { width, height }),
    given.image === undefined ? null : photoFrom(given.image, { width, height }),
    Promise.all(given.objects.map((object) => objectOf(object, depth))),
  ]);
  const names = given.objects.map(({ name }, i) => name ?? (objects.length === 1 ? "Object" : `Object ${i + 1}`));
  const inputs: Inputs = {
    ...noInputs,
    name: given.name ?? "Scene",
    objects: names.map((name) => ({ name, mask: null, mesh: null, truth: null, isSure: true })),
  };
  const camera = { fx, fy, cx, cy };
  const scene = sceneOf(inputs, { depth, camera, photo, objects, problems: [], warnings: [] });
  if (scene === null) throw new Error("A scene has at least one object.");
  return { scene, inputs, session: null };
}

async function depthOf({ depth, width = 0, height = 0, depthScale }: GivenScene): Promise<PixelArray<Float32Array>> {
  if (!(depth instanceof Float32Array || depth instanceof Uint16Array)) {
    return readDepth(depth, depthScale === undefined ? {} : { depthScale });
  }
  if (width * height !== depth.length) {
    throw new Error(`depth has ${depth.length} values; expected width × height, ${width} × ${height}.`);
  }
  const scale = depthScale ?? (depth instanceof Uint16Array ? 0.001 : 1);
  return { data: scale === 1 ? (depth as Float32Array) : Float32Array.from(depth, (z) => z * scale), width, height };
}

async function objectOf({ mask, mesh }: GivenObject, { width, height }: PixelArray<Float32Array>): Promise<ReadObject> {
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
