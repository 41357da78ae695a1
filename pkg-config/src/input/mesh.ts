/** Meshes from arrays or mesh files. */

import type { Formats, ReadMeshOptions } from "../modules/exports.js";
import { WasmModule } from "../modules/module.js";
import type { FileReaders } from "../modules/readers.js";
import type { ColorSamples, MeshFromFile } from "../types/files.js";
import type { MeshFile } from "../types/inputs.js";
import { failure, invalidArgument, Sim3AlignError } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import { oneOf, part, stringsIn, withoutUndefined, wrongKind } from "../values/validation.js";
import { callReader, fileBytes } from "./bytes.js";
import { type ColorArray, rgbOf } from "./colors.js";
import { formatsText } from "./formats.js";
import type { DecodeGeometry, MeshDecoders } from "./mesh-decoders.js";
import { holdsGaussians } from "./splat-files.js";
import { type DecodeImage, gltfText, imageDecoder } from "./webp.js";

/** The readers of mesh files. */
export type MeshReaders = Pick<FileReaders, "formats" | "splats" | "webp">;

/**
 * Reads a mesh file of any supported format. The module for 3D Gaussians is loaded only for these.
 * @param argument the name of the bytes, in errors
 * @param options of the formats module, which checks them
 * @param rename of the arguments in errors of the reader
 * @param own the caller's decoders of compressed geometry, in place of those of the package
 */
export async function decodeMesh(
  argument: string,
  bytes: Uint8Array,
  options: object,
  readers: MeshReaders,
  rename?: (argument: string) => string,
  own: MeshDecoders = {},
): Promise<MeshFromFile> {
  const { format, colors } = options as { format?: unknown; colors?: unknown };
  if (holdsGaussians(bytes, format)) {
    const withColors = colors === undefined || Boolean(colors);
    return callReader(readers.splats, argument, bytes, (module) => module.readSplats(bytes, withColors), rename);
  }
  const { resources, decodeImage } = options as { resources?: unknown; decodeImage?: DecodeImage };
  const decoder = colors === false ? undefined : await imageDecoder(bytes, resources, decodeImage, readers);
  const read = { ...options, ...withoutUndefined({ decodeImage: decoder }) } as ReadMeshOptions;
  const decode = await geometryDecoder(gltfText(bytes), own);
  try {
    const mesh = (module: Formats) => module.readMesh(...decode(bytes, read));
    return await callReader(readers.formats, argument, bytes, mesh, rename);
  } catch (error) {
    // By the ending of its name, a file of another format is damaged.
    if (!(error instanceof Sim3AlignError && maybeForeign.has(error.code))) throw error;
    const { foreignMesh } = await import("./foreign-meshes.js");
    const known = foreignMesh(bytes);
    if (known === undefined) throw error;
    const expected = formatsText("mesh");
    throw failure("UNSUPPORTED_FORMAT", error.argument, known.found, expected, known.remedy);
  }
}

/** The errors of files of other formats. */
const maybeForeign: ReadonlySet<string> = new Set(["UNSUPPORTED_FORMAT", "CORRUPT_FILE", "EMPTY_MESH"]);

/** The decoder of Draco, which is compiled once; its own script makes instances. */
const draco = /* @__PURE__ */ new WasmModule(
  "draco",
  () => new URL("../wasm/draco_bg.wasm", import.meta.url),
  () => undefined,
);

/** Rewrites a glTF file, whose JSON this is, without the compression of its geometry. The decoders are loaded only for compressed files. */
async function geometryDecoder(json: string, own: MeshDecoders): Promise<DecodeGeometry> {
  if (!/_meshopt_|_draco_/.test(json)) return (...file) => file;
  const [{ geometryDecoder }, { ownDecoders }] = await Promise.all([
    import("./compressed-gltf.js"),
    import("./own-decoders.js"),
  ]);
  const decoders = await ownDecoders(json, own, () => draco.compile());
  const { meshoptDecoder, dracoDecoder } = { ...decoders, ...withoutUndefined(own) };
  return geometryDecoder(meshoptDecoder, dracoDecoder);
}

const kinds = () =>
  `{ positions, indices? }, or the bytes of a file: ${formatsText("mesh")} (also as { bytes, format?, resources?, colorSpace? })`;

/** A mesh for the core, why it has no colours, and the content of its file that was not read. */
export interface MeshAndWarnings {
  mesh: CoreMesh;
  warnings: readonly string[];
  unread?: readonly string[] | undefined;
}

/**
 * The arrays of a mesh.
 * @param withColors whether the colours are needed
 */
export async function readMesh(mesh: unknown, readers: MeshReaders, withColors: boolean): Promise<MeshAndWarnings> {
  if (isRecord(mesh) && "positions" in mesh) {
    // `readMesh` of `sim3align/formats` adds warnings.
    const warnings = stringsIn(mesh.warnings);
    return { mesh: { ...arrays(mesh, withColors), ...lacking(warnings) }, warnings, unread: stringsIn(mesh.unread) };
  }
  const file: { [K in keyof MeshFile]?: unknown } = isRecord(mesh) ? mesh : { bytes: mesh };
  const bytes = await fileBytes("mesh", file.bytes);
  if (bytes === null) throw invalidArgument("mesh", mesh, kinds(), "Pass the mesh to align.");
  const { format, resources, colorSpace } = file as Omit<MeshFile, "bytes">;
  const options = { ...withoutUndefined({ format, resources, colorSpace }), colors: withColors };
  const read = await decodeMesh("mesh", bytes, options, readers, ofMesh);
  const { warnings, unread, origin, ...found } = read;
  // Poses are of the mesh that the caller passed: that of a file keeps its coordinates.
  return { mesh: { ...found, ...lacking(warnings), ...withoutUndefined({ fileOrigin: origin }) }, warnings, unread };
}

const lacking = (warnings: readonly string[]) => (warnings.length > 0 ? { lacksColors: true } : {});

/**
 * The same for a call of the core.
 * @param meshId the id of a prepared mesh
 */
export async function readCoreMesh(
  mesh: unknown,
  readers: MeshReaders,
  withColors: boolean,
  meshId?: number,
): Promise<MeshAndWarnings> {
  // A prepared mesh is cached with its colours: a later call may have a photo.
  const { mesh: arrays, ...notes } = await readMesh(mesh, readers, withColors || meshId !== undefined);
  return { mesh: withoutUndefined({ ...arrays, id: meshId }) as CoreMesh, ...notes };
}

/** The options of the reader are properties of the mesh. */
const ofMesh = (argument: string) => argument.replace(/^options\./, "mesh.");

function arrays({ positions, indices, ...more }: Record<string, unknown>, withColors: boolean): CoreMesh {
  if (!isTypedArray<Float32Array>(positions, "Float32Array")) {
    throw wrongKind("mesh.positions", positions, "a Float32Array, x, y, z per vertex", "Float32Array");
  }
  // Checked in any case: whether colours are wrong must not depend on the photo.
  const colors = colorsOf(more, positions.length / 3);
  const origin = Array.isArray(more.fileOrigin) ? { fileOrigin: more.fileOrigin as number[] } : {};
  const copies = typeof more.copies === "number" ? { copies: more.copies } : {};
  const found = { positions, ...origin, ...copies, ...(withColors ? colors : {}) };
  if (indices === undefined || indices === null) return found;
  if (isTypedArray<Uint32Array | Uint16Array>(indices, "Uint32Array", "Uint16Array")) return { ...found, indices };
  const expected = "a Uint32Array or a Uint16Array, three indices per triangle";
  throw wrongKind("mesh.indices", indices, expected, "Uint32Array");
}

function colorsOf(
  { colors, colorSpace, samples }: Record<string, unknown>,
  vertices: number,
): Pick<CoreMesh, "colors" | "samples"> {
  const space = oneOf("mesh.colorSpace", colorSpace ?? "srgb", ["srgb", "linear"]);
  if (samples !== undefined && samples !== null) return { samples: samplesOf(samples) };
  if (colors === undefined || colors === null) return {};
  if (!isTypedArray<ColorArray>(colors, "Uint8Array", "Uint8ClampedArray", "Float32Array")) {
    const expected = "a Uint8Array (0 to 255) or a Float32Array (0 to 1), RGB or RGBA per vertex";
    throw wrongKind("mesh.colors", colors, expected, "Uint8Array");
  }
  const channels = [3, 4].find((count) => colors.length === count * vertices);
  if (channels !== undefined) return { colors: rgbOf(colors, channels, space) };
  const found = `${colors.length} values for ${vertices} vertices`;
  const remedy = "Pass the colours of the same mesh, vertex by vertex.";
  throw failure("WRONG_LENGTH", "mesh.colors", found, "3 or 4 per vertex", remedy);
}

/** The samples of the `readMesh` of `sim3align/formats`. */
function samplesOf(samples: unknown): ColorSamples {
  const expected = "{ positions, normals, colors } of a mesh that was read from a file";
  const { positions, normals, colors, flippedColors = colors } = part("mesh.samples", samples, expected);
  for (const [name, array] of Object.entries({ positions, normals })) {
    if (!isTypedArray<Float32Array>(array, "Float32Array")) {
      throw wrongKind(`mesh.samples.${name}`, array, "a Float32Array, x, y, z per point", "Float32Array");
    }
  }
  for (const [name, array] of Object.entries({ colors, flippedColors })) {
    if (!isTypedArray<Uint8Array>(array, "Uint8Array")) {
      throw wrongKind(`mesh.samples.${name}`, array, "a Uint8Array, RGB per point", "Uint8Array");
    }
  }
  const arrays = { colors, positions, normals, flippedColors } as ColorSamples & { flippedColors: Uint8Array };
  const [count, ...others] = Object.values(arrays).map(({ length }) => length);
  if ((count as number) % 3 !== 0 || others.some((other) => other !== count)) {
    const found = `${count} colour values for ${others.slice(0, 2).join(" and ")} coordinates`;
    throw failure("WRONG_LENGTH", "mesh.samples", found, "three of each per point", "Pass what readMesh() returned.");
  }
  return flippedColors === colors ? (samples as ColorSamples) : arrays;
}
