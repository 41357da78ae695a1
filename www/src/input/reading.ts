/** Reads the input files of a scene. Each field is read by itself, so that all problems are known at once. */
import type { DepthKind, MeshArrays, PixelArray } from "sim3align";
import { type MeshFromFile, readExif, readPose } from "sim3align/formats";
import { type Camera, cameraOf, unitOf } from "sim3align/input/camera";
import { photoHint } from "sim3align/input/lens";
import type { ImageSize } from "sim3align/values/pixels";
import type { CameraSource, Field, Inputs, NamedFile } from "../state/inputs.js";
import { ObjectModel, type ObjectParts } from "../state/object-model.js";
import type { RawView, Scene } from "../state/scene.js";
import { visibleExtent } from "../state/scene.js";
import { type ReadCamera, readDepthMap, viewOf } from "./depth-view.js";
import { baseName } from "./files.js";
import { atSize, maskOf, meshOf } from "./object-files.js";
import { type Photo, readPhoto } from "./photo.js";
import { errorOf, type Problem } from "./problems.js";

/** Colours of objects, distinguishable on light and dark backgrounds and with most colour vision deficiencies. */
const colours = ["#f08a24", "#3c9ee5", "#2fa36b", "#c65fd0", "#d64545", "#a58a00"];

export const colourOf = (index: number): string => colours[index % colours.length] ?? "#f08a24";

/** An object, as far as it could be read. */
export interface ReadObject {
  mask: Uint8Array | null;
  /** Which values of the mask file are the object, for people. */
  maskReading?: string | undefined;
  mesh: MeshFromFile | null;
  glb: Uint8Array | null;
  truth: ObjectParts["truth"];
  initial?: ObjectParts["initial"];
}

/** The inputs, as far as they could be read. */
export interface Reading {
  /** Metres, or what is shown until it is calibrated. */
  depth: PixelArray<Float32Array> | null;
  /** What is to be calibrated. */
  raw: RawView | null;
  depthKind: DepthKind;
  depthUnit: Scene["depthUnit"] | null;
  camera: Scene["camera"] | null;
  /** Where the camera comes from, if none was given. */
  cameraSource: string | null;
  /** Of the focal length, relative; 0 where it is known. */
  focalUncertainty: number;
  /** The size of the image to which the camera belongs: that of the depth map or, without one, of the photo. */
  size: ImageSize | null;
  photo: Photo | null;
  /** The size of the pixels of photo and masks, which is smaller than `size` for a large photo without a depth map. */
  shown: ImageSize | null;
  objects: readonly ReadObject[];
  /** Found by the readers. */
  problems: readonly Problem[];
  warnings: readonly string[];
}

/** What a scene is made of. */
export type SceneReading = Omit<Reading, "focalUncertainty" | "size" | "shown" | "problems" | "depthKind">;

/** How many of the parts of a scene are read. */
export interface ReadingProgress {
  done: number;
  total: number;
}

/** Reads all inputs that are there. */
export async function readInputs(
  inputs: Inputs,
  onProgress: (progress: ReadingProgress) => void = () => {},
): Promise<Reading> {
  const problems: Problem[] = [];
  const progress = { done: 0, total: 0 };
  const attempt = async <T>(
    field: Field,
    file: NamedFile | null,
    read: () => Promise<T>,
    object?: number,
  ): Promise<T | null> => {
    progress.total++;
    try {
      return await read();
    } catch (cause) {
      problems.push(errorOf(field, cause, object, file === null ? undefined : baseName(file.path)));
      return null;
    } finally {
      progress.done++;
      onProgress({ ...progress });
    }
  };
  const { depth: depthFile, camera: source, imageId } = inputs;
  // The camera file may state the unit of an integer depth map.
  const cameraFile = source?.kind === "file" ? source.file : null;
  const stated = await attempt("camera", cameraFile, () => cameraFrom(source, imageId));
  const scales = { depthScale: inputs.depthScale ?? undefined, integerDepthScale: stated?.unit?.metres };
  const read =
    depthFile === null
      ? null
      : await attempt("depth", depthFile, () => readDepthMap(depthFile, inputs.depthKind, scales));
  const { photo: photoFile } = inputs;
  // Beside a depth map that cannot be read, photo and masks are shown all the same.
  const readingPhoto = photoFile === null ? null : attempt("photo", photoFile, () => readPhoto(photoFile, read));
  // Without both, masks are shown by themselves.
  const [mask] = inputs.objects.flatMap(({ mask }) => mask ?? []);
  const shown =
    read ?? (await readingPhoto)?.shown ?? (mask === undefined ? null : await maskOf(mask).catch(() => null));
  const [photo, objects] = await Promise.all([
    readingPhoto,
    Promise.all(
      inputs.objects.map(async ({ mask, mesh, truth, initial }, i): Promise<ReadObject> => {
        let maskReading: string | undefined;
        const [readMask, readMesh, readTruth, first] = await Promise.all([
          mask === null || shown === null
            ? null
            : attempt(
                "mask",
                mask.file,
                async () => {
                  const own = await maskOf(mask);
                  maskReading = own.reading;
                  const isOfPhoto = isSameSize(own, await readingPhoto);
                  return atSize(own, shown.width, shown.height, inputs.resizeMasks || isOfPhoto || read === null);
                },
                i,
              ),
          mesh === null ? null : attempt("mesh", mesh.file, () => meshOf(mesh), i),
          truthOf(truth),
          truthOf(initial ?? null),
        ]);
        const { mesh: arrays = null, glb = null } = readMesh ?? {};
        return { mask: readMask, maskReading, mesh: arrays, glb, truth: readTruth, initial: first?.transform };
      }),
    ),
  ]);
  const size: ImageSize | null = read ?? photo;
  const camera =
    size === null || stated === null
      ? null
      : await attempt("camera", cameraFile, async () => {
          const exif = source === null && photoFile !== null ? await exifOf(photoFile) : undefined;
          const hints = { inDepth: read?.camera, photo: await photoHint(exif, photo) };
          return resolved(stated, size, hints, source);
        });
  const view = read && viewOf(read, camera);
  const { unit, warnings: ofUnit } =
    read && stated ? unitOf(read.unit, stated) : { unit: read?.unit ?? null, warnings: [] };
  return {
    ...{ photo, objects, problems, size, shown, warnings: [...(camera?.warnings ?? []), ...ofUnit.map(messageOf)] },
    depth: view && read && { data: view.depthM, width: read.width, height: read.height },
    raw: view?.raw ?? null,
    depthKind: read?.depthKind ?? "metric",
    depthUnit: unit,
    camera: camera?.camera ?? null,
    cameraSource: camera?.source ?? null,
    focalUncertainty: camera?.focalUncertainty ?? 0,
  };
}

/** The scene, or null while a part is missing. A frame of a video may lack its mask. */
export function sceneOf(inputs: Inputs, reading: SceneReading, isFrame = false): Scene | null {
  const { depth, camera, photo, objects, raw, depthUnit, cameraSource, warnings } = reading;
  if (depth === null || depthUnit === null || camera === null) return null;
  const models: ObjectModel[] = [];
  for (const [i, { mask: ownMask, mesh, glb, truth, initial }] of objects.entries()) {
    const mask = ownMask ?? (isFrame && inputs.objects[i]?.mask === null ? new Uint8Array(depth.data.length) : null);
    if (mask === null || mesh === null) return null;
    const { name } = inputs.objects[i] as Inputs["objects"][number];
    const parts = { id: `${i}`, name, colour: colourOf(i), mask, mesh: mesh as MeshArrays, glb, truth, initial };
    models.push(new ObjectModel(parts, visibleExtent(depth, mask, camera)));
  }
  if (models.length === 0) return null;
  const { data: depthM, width, height } = depth;
  const { name, sample } = inputs;
  return {
    ...{ name, sample, depthM, width, height, camera, raw, depthUnit, cameraSource, warnings },
    ...{ calibration: null, rgba: photo?.rgba ?? null, objects: models },
  };
}

const messageOf = ({ message }: { message: string }) => message;

const isSameSize = (a: ImageSize, b: ImageSize | null) => a.width === b?.width && a.height === b.height;

/** Camera files to which the number in the name of a depth map says nothing. */
export const withoutIds = new WeakSet<NamedFile>();

/** The camera of a source, whose intrinsics may depend on the size of the image. */
async function cameraFrom(source: CameraSource | null, imageId: string | null): Promise<Camera> {
  if (source === null) return cameraOf({});
  if (source.kind === "file") {
    if (await isCut(source.file)) throw new Error("The file is cut off: its JSON does not end. Export it again.");
    const cameraFile = await source.file.bytes();
    const ofImage = imageId === null ? null : await cameraOf({ cameraFile, imageId }).catch(() => null);
    if (ofImage !== null) return ofImage;
    withoutIds.add(source.file);
    return cameraOf({ cameraFile });
  }
  const { kind: _, ...camera } = source;
  return cameraOf({ camera });
}

/** Whether a file begins as JSON, and ends before it is complete. */
async function isCut(file: NamedFile): Promise<boolean> {
  const text = new TextDecoder().decode(await file.bytes()).trim();
  return /^[[{]/.test(text) && !/[\]}]$/.test(text);
}

const exifOf = async (photo: NamedFile) => readExif(await photo.bytes()).catch(() => undefined);

function resolved(
  camera: Camera,
  { width, height }: ImageSize,
  hints: Parameters<Camera["resolve"]>[2],
  source: CameraSource | null,
): ReadCamera {
  const found = camera.resolve(width, height, hints);
  if (found.camera === undefined) throw new Error("The image has no pixels.");
  const warnings = [...found.warnings.map(messageOf), ...(found.unread ?? [])];
  const assumed =
    source?.kind === "assumed"
      ? [`The camera is assumed (vertical field of view ${source.fovYDeg}°), so the size is approximate.`]
      : [];
  return {
    ...{ camera: found.camera, source: found.source ?? null, warnings: [...assumed, ...warnings] },
    focalUncertainty: found.focalDeviation ?? 0,
  };
}

/** A pose in a file. It only serves for comparison, or as a candidate, so an unreadable file counts as a missing one. */
const truthOf = async (file: NamedFile | null): Promise<ObjectParts["truth"]> =>
  file && readPose(await file.bytes()).catch(() => null);
