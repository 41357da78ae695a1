/**
 * Readers for depth maps, masks, meshes, cameras, poses, case and scene folders, and outputs of SAM 3D Objects, without the
 * aligner. `Aligner.align` accepts single files directly; use their readers to inspect their content.
 * @packageDocumentation
 */

import type { CameraFile, ReadCameraOptions } from "./camera/camera-file.js";
import { type Case, type CaseFiles, caseFrom, ownFiles, type ReadCaseOptions } from "./case-files.js";
import { type KnownPose, parsePoseFile } from "./conventions/pose-file.js";
import { type Frames, folderOf, framesIn } from "./frames.js";
import { beginsLikeJson, callReader, requiredBytes } from "./input/bytes.js";
import { decodeDepth } from "./input/depth.js";
import { readJsonMask } from "./input/mask.js";
import { decodeMesh } from "./input/mesh.js";
import type { DracoDecoderModule, MeshoptDecoder } from "./input/mesh-decoders.js";
import { decodeExif, decodePhoto } from "./input/photo.js";
import type { DecodeImage } from "./input/webp.js";
import type { Formats } from "./modules/exports.js";
import { fileReaders, formatsModule } from "./modules/readers.js";
import { sam3dFrom } from "./scene/sam3d-files.js";
import { type SceneCase, sceneFrom } from "./scene/scene-files.js";
import type { Exif, ExternalResources, MaskFromFile, MeshFromFile } from "./types/files.js";
import type {
  CameraFileInput,
  CocoRle,
  DepthImage,
  EncodedBytes,
  MaskJson,
  MeshFormat,
  ReadDepthOptions,
} from "./types/inputs.js";
import type { WasmSource } from "./types/platform.js";
import { plainArgument } from "./values/border.js";
import type { JsonFile } from "./values/json.js";
import { isRecord } from "./values/kinds.js";
import type { PixelArray } from "./values/pixels.js";
import { optionsOf } from "./values/validation.js";

export type { CameraFile, ReadCameraOptions } from "./camera/camera-file.js";
export { type ExifFocal, focalFromExif } from "./camera/exif-focal.js";
export type { Case, CaseFiles, FoundFiles, ReadCaseOptions } from "./case-files.js";
export type { KnownPose } from "./conventions/pose-file.js";
export type { Frame, Frames } from "./frames.js";
export type {
  DracoAttribute,
  DracoBuffer,
  DracoClass,
  DracoDecoder,
  DracoDecoderModule,
  DracoMesh,
  DracoStatus,
  MeshoptDecoder,
} from "./input/mesh-decoders.js";
export type { DecodeImage } from "./input/webp.js";
export type { SceneCase } from "./scene/scene-files.js";
export type { Exif, ExternalResources, MaskFromFile, MeshFromFile } from "./types/files.js";
export type { DepthImage, ReadDepthOptions } from "./types/inputs.js";
export { Sim3AlignError } from "./values/error.js";

/**
 * Loads the formats module. Only needed if it is not at `wasm/formats_bg.wasm` next to this script; only the `wasm` of
 * the first successful call is used.
 * @throws {@link Sim3AlignError} `NOT_INITIALISED`; the next call tries again
 */
export async function loadFormats(wasm?: WasmSource): Promise<void> {
  await formatsModule.load(wasm);
}

/**
 * Reads a depth file (NPY, 16-bit PNG, NPZ, EXR, TIFF or PFM), of an NPZ with the mask and the camera in it. The last four
 * load another module, `wasm/depth-files_bg.wasm` next to this script.
 * @param options.depthScale metres per unit, above 0; by default integers are millimetres, and floats metres
 * @param options.integerDepthScale the same for integers only: the `depthScale` of a camera file
 * @param options.depthKind what the values are, `"metric"` by default; PNGs and arrays of 8 bits are read for the
 * affine-invariant kinds only
 * @param options.depthCode the code of the values, if they are no lengths, with `depthNear` and `depthFar` in metres
 * @throws {@link Sim3AlignError} for any other file
 */
export async function readDepth(file: EncodedBytes, options: ReadDepthOptions = {}): Promise<DepthImage> {
  const given = optionsOf(options, [
    ...(["depthScale", "integerDepthScale", "depthKind", "depthCode", "depthNear", "depthFar"] as const),
  ]);
  const bytes = await requiredBytes("file", file);
  return decodeDepth("file", bytes, given, fileReaders);
}

/**
 * Reads a mask file (PNG, NPY, JSON or JPEG), or the content of a JSON file: COCO RLE, or a file of COCO, SAM, LabelMe, VGG
 * Image Annotator, Supervisely, ISAT or Datumaro. The outline of a mask with soft edges is at half of its range, that of logits at 0; in
 * a map of labels, all are the object.
 * @param options.index the place of the mask in a JSON file of several, from 0
 * @param options.width the width of the image, for polygons whose file does not state it, with `height`
 * @returns row-major; 1 is the object
 * @throws {@link Sim3AlignError} for any other file
 */
export async function readMask(
  file: EncodedBytes | CocoRle | MaskJson,
  options: { index?: number | undefined; width?: number | undefined; height?: number | undefined } = {},
): Promise<MaskFromFile> {
  const { index, width, height } = optionsOf(options, ["index", "width", "height"]);
  const size = width === undefined || height === undefined ? undefined : { width, height };
  const isJson = isRecord(file) || Array.isArray(file);
  const bytes = isJson ? undefined : await requiredBytes("file", file);
  if (bytes !== undefined && !beginsLikeJson(bytes)) return call(bytes, (readers) => readers.readMask(bytes));
  const content = bytes ?? plainArgument("file", file as object);
  return (await readJsonMask("mask", content, index, size, fileReaders.formats)) as MaskFromFile;
}

/**
 * Reads a photo file (PNG, JPEG or WebP). The EXIF orientation is applied; alpha and colour profiles are ignored; a photo of
 * more than two megapixels is reduced by a whole number.
 * @returns red, green and blue per pixel, row-major, sRGB-encoded
 * @throws {@link Sim3AlignError} for any other file
 */
export async function readImage(file: EncodedBytes): Promise<PixelArray<Uint8Array>> {
  const bytes = await requiredBytes("file", file);
  return decodePhoto(bytes, fileReaders);
}

/**
 * Reads the EXIF data of a photo file (PNG, JPEG or WebP). What they do not state, or what is damaged, is missing.
 * @throws {@link Sim3AlignError} for any other file
 */
export async function readExif(file: EncodedBytes): Promise<Exif> {
  const bytes = await requiredBytes("file", file);
  return decodeExif(bytes, fileReaders);
}

/**
 * Reads a mesh file (GLB, glTF, OBJ, PLY, STL or SPLAT). Merges all parts, and applies node transforms. Of 3D Gaussians (in a
 * PLY or SPLAT file), another module, `wasm/splats_bg.wasm` next to this script, makes a closed mesh of the surface that the
 * opaque ones show. The result can be passed as `mesh`, with its colours.
 * @param options.format by default detected from the content
 * @param options.resources the files that the mesh file refers to, by name: see {@link externalResources}
 * @param options.colors whether to read the colours, `true` by default
 * @param options.decodeImage decodes textures that are neither PNG, JPEG nor WebP, such as KTX2, to RGB pixels
 * @param options.colorSpace what the vertex colours of a glTF are; by default, bytes are sRGB-encoded, and others linear unless a
 * program wrote them that does not convert colours
 * @param options.meshoptDecoder decodes geometry compressed with meshopt in place of the package's decoder: `MeshoptDecoder` of the
 * npm package `meshoptimizer`
 * @param options.dracoDecoder the same for Draco: `await createDecoderModule()` of the npm package `draco3d`
 * @throws {@link Sim3AlignError} for any other file, and `COMPRESSED_MESH` for compressed geometry if its decoder cannot be loaded
 */
export async function readMesh(
  file: EncodedBytes,
  options: {
    format?: MeshFormat | undefined;
    resources?: Readonly<Record<string, Uint8Array | ArrayBuffer>> | undefined;
    colors?: boolean | undefined;
    colorSpace?: "srgb" | "linear" | undefined;
    decodeImage?: DecodeImage | undefined;
    meshoptDecoder?: MeshoptDecoder | undefined;
    dracoDecoder?: DracoDecoderModule | undefined;
  } = {},
): Promise<MeshFromFile> {
  const { meshoptDecoder, dracoDecoder, ...given } = optionsOf(options, [
    ...(["format", "resources", "colors", "colorSpace", "decodeImage", "meshoptDecoder", "dracoDecoder"] as const),
  ]);
  const bytes = await requiredBytes("file", file);
  return decodeMesh("file", bytes, given, fileReaders, undefined, { meshoptDecoder, dracoDecoder });
}

/**
 * The files that a glTF, OBJ or PLY file refers to, by the names in it, unchanged. The material libraries of an `.obj` refer
 * to textures: call it with their content, too.
 * @throws {@link Sim3AlignError} for a glTF or PLY that cannot be read
 */
export async function externalResources(file: EncodedBytes): Promise<ExternalResources> {
  const bytes = await requiredBytes("file", file);
  return call(bytes, (readers) => readers.externalResources(bytes));
}

/**
 * Reads a camera file: sim3align's `camera.json`, BOP's `scene_camera.json`, ROS CameraInfo, the intrinsics of Open3D,
 * RealSense, Record3D, Polycam or nerfstudio, OpenCV's YAML, COLMAP's cameras.txt, numbers as text (`K.txt`) or as NPY, and
 * more, which the guide on frames lists; bytes, text or parsed JSON. It needs no WebAssembly. Intrinsics for an image of another size are scaled to `options`.
 * @throws {@link Sim3AlignError} for any other file, and `SIZE_MISMATCH` for intrinsics of an image of another shape
 */
export async function readCamera(file: CameraFileInput, options: ReadCameraOptions = {}): Promise<CameraFile> {
  const given = optionsOf(options, ["width", "height", "imageId"]);
  const content = await jsonOf("camera", file);
  const { parseCameraFile } = await import("./camera/camera-file.js");
  return parseCameraFile(content, given);
}

/**
 * Reads a pose file: `{ scale, rotation, translation }`, `{ matrix }` (column-major), or an entry of BOP's
 * `scene_gt.json`; bytes, text or parsed JSON. It needs no WebAssembly.
 * @returns `null` if the file declares that no pose is known
 * @throws {@link Sim3AlignError} for any other file
 */
export async function readPose(file: EncodedBytes | string | object): Promise<KnownPose | null> {
  return parsePoseFile("pose", await jsonOf("pose", file));
}

/**
 * Reads a case folder: a depth file (NPY, 16-bit PNG, NPZ, EXR, TIFF or PFM) called `depth`, a mask file (PNG, NPY, JSON or
 * JPEG) called `mask`, a mesh file (GLB, glTF, OBJ, PLY, STL or SPLAT) called `mesh`, and optionally a camera file (JSON,
 * text, YAML, XML, INI or NPY: `camera`, `K`, `intrinsics`, …), a photo file (PNG, JPEG or WebP: `rgb`, `image`, …), and `gt.json`. The guide
 * on frames lists all names. Upper and lower case are the same. Intrinsics of the colour camera are passed over beside those of
 * the depth camera (`intrinsic_depth.txt`). What is not read is in `unread`.
 * @param files by name, relative to the folder
 *
 * @example
 * const { input, truth } = await readCase({ "depth.png": depth, "mask.png": mask, "mesh.glb": mesh, "camera.json": camera });
 * const result = await aligner.align(input);
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readCase(files: CaseFiles, settings: ReadCaseOptions = {}): Promise<Case> {
  return caseFrom(ownFiles(files), caseOptions(settings));
}

/**
 * Reads a scene folder: a depth map and, optionally, a camera and a photo, as in a case folder; and
 * `objects/NAME/` with `mask.*`, `mesh.*` and, optionally, `initial.json` (a pose to start from) and `gt.json`.
 * @param files by path, relative to the folder
 *
 * @example
 * const { input, truths } = await readScene({ "depth.png": depth, "objects/mug/mask.png": mask, "objects/mug/mesh.glb": mesh });
 * const result = await aligner.alignScene(input);
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readScene(files: CaseFiles, settings: ReadCaseOptions = {}): Promise<SceneCase> {
  return sceneFrom(ownFiles(files), caseOptions(settings));
}

/**
 * Reads the mesh of a folder of frames, and each frame when it is needed: a folder with `mesh.*` and `frame_*` folders, each with
 * the files of a case but the mesh; or one in the layout of FoundationPose, with a file per frame in `depth/`, `rgb/` and `masks/`, and
 * `mesh/`. A camera beside these is that of the frames without one.
 * @param files by path, relative to the folder
 *
 * @example
 * const { mesh, names, read } = await readFrames(files);
 * const tracker = await aligner.track(mesh);
 * for (const name of names) {
 *   const { cameraToWorld, ...view } = (await read(name)).input;
 *   console.log(await tracker.next(view));
 * }
 * @throws {@link Sim3AlignError} `FILE_NOT_FOUND` with the expected names, `INVALID_ARGUMENT` for several files of one part
 */
export async function readFrames(files: CaseFiles, settings: ReadCaseOptions = {}): Promise<Frames> {
  return framesIn(folderOf(ownFiles(files)), caseOptions(settings));
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
export async function readSam3d(files: CaseFiles, settings: ReadCaseOptions = {}): Promise<SceneCase> {
  return sam3dFrom(ownFiles(files), caseOptions(settings));
}

const caseOptions = (settings: ReadCaseOptions) =>
  optionsOf(settings, [
    ...(["depthScale", "imageId", "resizeMask", "maskIndex", "depthKind", "image"] as const),
    ...(["depthCode", "depthNear", "depthFar"] as const),
  ]);

async function jsonOf(argument: string, file: EncodedBytes | string | object): Promise<JsonFile> {
  const given = plainArgument(argument, file);
  return typeof given === "string" || isRecord(given) || Array.isArray(given) ? given : requiredBytes("file", given);
}

const call = <T>(bytes: Uint8Array, read: (readers: Formats) => T): Promise<T> =>
  callReader(() => formatsModule.load(), "file", bytes, read);
