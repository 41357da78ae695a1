/** Reads a scene: the view once, and a mask per object. */

import { readMask, shapedMask } from "../input/mask.js";
import { resolveView } from "../input/resolve.js";
import type { CoreView } from "../modules/core-input.js";
import type { FileReaders, LoadFormats } from "../modules/readers.js";
import type { InputNotes } from "../types/results.js";
import type { SceneInput, SceneObjectInput } from "../types/scene.js";
import { describe, failure, invalidArgument, renamed, Sim3AlignError } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { nearest } from "../values/pixels.js";
import { checkNames, part, withoutUndefined } from "../values/validation.js";

/** A scene whose images have been read. */
export interface ReadScene {
  /** The view of all objects. */
  view: CoreView;
  /** Width and height of the depth map, pixels. */
  size: [width: number, height: number];
  objects: ReadObject[];
  /** Masks of objects without a mesh. */
  occluders: Uint8Array[];
  /** The number of masks that each pixel is in; `undefined` for a single mask. */
  counts: Uint16Array | undefined;
  support: unknown;
  notes: InputNotes;
}

/** Properties of an object beside its mask and mesh. */
type KnownOfObject = Omit<SceneObjectInput, (typeof objectProperties)[number]>;

/** An object whose mask has been read. */
export interface ReadObject {
  name: string | undefined;
  mask: Uint8Array;
  /** Which values of its mask file are the object, for people. */
  maskReading?: string | undefined;
  mesh: unknown;
  known: KnownOfObject;
}

const objectProperties = ["name", "mask", "label", "resizeMask", "maskIndex", "mesh"] as const;
const knownProperties: readonly string[] = [
  "scale",
  "knownExtentM",
  "knownExtentAxis",
  "meshUp",
  "cameraUp",
  "symmetry",
  "initial",
  "search",
  "quality",
] satisfies (keyof KnownOfObject)[];

/**
 * Reads a scene.
 * @throws {@link Sim3AlignError} for arguments of the wrong type, masks of another size, and the errors of the readers
 */
export async function readScene(scene: SceneInput, readers: FileReaders): Promise<ReadScene> {
  const parts = part("scene", scene, "{ depth, camera, objects }");
  const { objects, labels, occluders, support, ...rest } = parts as SceneInput & Record<string, unknown>;
  const { formats } = readers;
  const { core: view, notes } = await resolveView(rest, readers);
  const size: [number, number] = [Number(view.width), Number(view.height)];
  const read = { size, formats, labels: labels === undefined ? undefined : checkedLabels(labels, size) };
  const given = listOf("objects", objects);
  if (given.length === 0) throw invalidArgument("objects", objects, "at least one object", "Pass { mask, mesh }.");
  const readObjects: ReadObject[] = [];
  for (const [i, object] of given.entries()) readObjects.push(await readObject(`objects[${i}]`, object, read));
  const masks: Uint8Array[] = [];
  for (const [i, mask] of listOf("occluders", occluders ?? []).entries()) {
    masks.push((await maskOf(`occluders[${i}]`, mask, undefined, read)).mask);
  }
  const others = otherLabels(given, read.labels);
  if (others !== null) masks.push(others);
  return {
    view,
    size,
    objects: readObjects,
    occluders: masks,
    counts: countsOf([...readObjects.map(({ mask }) => mask), ...masks]),
    support: support === undefined ? "auto" : support,
    notes,
  };
}

interface Reading {
  size: [number, number];
  formats: LoadFormats;
  labels: ArrayLike<number> | undefined;
}

function listOf(name: string, value: unknown): unknown[] {
  if (Array.isArray(value)) return value;
  throw invalidArgument(name, value, "an array", "Pass [{ mask, mesh }, …].");
}

async function readObject(argument: string, object: unknown, read: Reading): Promise<ReadObject> {
  const properties = part(argument, object, "{ mask, mesh }");
  const all = [...objectProperties, ...knownProperties];
  const remedy = "Check the spelling. Options for all objects belong in the second argument.";
  checkNames(`${argument}.`, properties, all, remedy);
  const { name, mask, label, resizeMask, maskIndex, mesh, ...known } = properties as Partial<SceneObjectInput>;
  if (name !== undefined && typeof name !== "string") {
    throw invalidArgument(`${argument}.name`, name, "a string", "Pass the name of the object.");
  }
  const own =
    mask === undefined && label !== undefined
      ? { mask: labelled(`${argument}.label`, label, read) }
      : await maskOf(`${argument}.mask`, mask, resizeMask, read, maskIndex);
  return { name, ...own, mesh, known: withoutUndefined(known) as KnownOfObject };
}

async function maskOf(
  argument: string,
  mask: unknown,
  resize: unknown,
  read: Reading,
  index?: unknown,
): Promise<Pick<ReadObject, "mask" | "maskReading">> {
  const [width, height] = read.size;
  const size = { width, height };
  const whole = await readMask(mask, size, read.formats, index).catch((error) => {
    throw error instanceof Sim3AlignError ? renamed(error, error.argument.replace(/^mask/, argument)) : error;
  });
  const { data, reading: maskReading, ...own } = shapedMask(argument, whole, size, resize);
  const [from, rows] = [own.width ?? width, own.height ?? height];
  const pixels = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  if (pixels.length !== from * rows) {
    throw failure("WRONG_LENGTH", argument, `${pixels.length} values`, `${from} × ${rows}`, "Pass one per pixel.");
  }
  if (from === width && rows === height) return { mask: pixels, maskReading };
  if (resize !== "nearest") {
    const found = `${from} × ${rows} pixels for a depth map of ${width} × ${height}`;
    const remedy = 'Resize the mask to the depth map, or set resizeMask: "nearest".';
    throw failure("SIZE_MISMATCH", argument, found, "depth and mask of the same size", remedy);
  }
  const resized = Uint8Array.from({ length: width * height }, (_, i) => {
    const [u, v] = [i % width, Math.floor(i / width)];
    return pixels[nearest(v, height, rows) * from + nearest(u, width, from)] ?? 0;
  });
  return { mask: resized, maskReading };
}

const labelKinds = "{ data, width, height } with a Uint8Array, Uint16Array or Uint32Array";

function checkedLabels(labels: unknown, [width, height]: [number, number]): ArrayLike<number> {
  const { data, ...own } = isRecord(labels) ? labels : { data: undefined };
  if (!isTypedArray<Uint8Array>(data, "Uint8Array", "Uint8ClampedArray", "Uint16Array", "Uint32Array")) {
    throw invalidArgument("labels", labels, labelKinds, "Pass the label map of a segmentation.");
  }
  const { width: columns, height: rows } = own as { width?: unknown; height?: unknown };
  if (columns === width && rows === height && data.length === width * height) return data;
  const found = `${data.length} values of ${describe(columns)} × ${describe(rows)} pixels`;
  throw failure("SIZE_MISMATCH", "labels", found, `${width} × ${height} pixels, as the depth map`, "Resize it.");
}

function labelled(argument: string, label: unknown, { labels }: Reading): Uint8Array {
  if (labels === undefined) {
    throw invalidArgument(argument, label, "a mask, or a label with `labels` of the scene", "Pass the label map.");
  }
  if (!Number.isSafeInteger(label) || (label as number) < 1) {
    throw invalidArgument(argument, label, "an integer above 0", "0 is no object.");
  }
  return Uint8Array.from({ length: labels.length }, (_, i) => (labels[i] === label ? 1 : 0));
}

/** The pixels of labels without an object; `null` if there are none. */
function otherLabels(objects: readonly unknown[], labels: ArrayLike<number> | undefined): Uint8Array | null {
  if (labels === undefined) return null;
  const known = new Set<unknown>([0, ...objects.map((object) => (object as SceneObjectInput).label)]);
  const others = Uint8Array.from({ length: labels.length }, (_, i) => (known.has(labels[i]) ? 0 : 1));
  return others.includes(1) ? others : null;
}

function countsOf(masks: readonly Uint8Array[]): Uint16Array | undefined {
  const [first] = masks;
  if (first === undefined || masks.length < 2) return undefined;
  const counts = new Uint16Array(first.length);
  for (const mask of masks) {
    for (let i = 0; i < mask.length; i++) if (mask[i] !== 0) counts[i] = (counts[i] as number) + 1;
  }
  return counts;
}

/** The pixels of the objects other than that of a mask. */
export const othersOf = ({ counts }: ReadScene, mask: Uint8Array): Uint8Array | undefined =>
  counts && Uint8Array.from(counts, (count, i) => (count > (mask[i] !== 0 ? 1 : 0) ? 1 : 0));
