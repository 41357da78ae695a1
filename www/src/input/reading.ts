/** Reads the input files of a scene. Each field is read by itself, so that all problems are known at once. */
import type { DepthKind, MeshArrays, PixelArray } from "sim3align";
import { type CameraFile, type MeshFromFile, readCamera, readPose } from "sim3align/formats";
import type { ImageSize } from "sim3align/values/pixels";
import type { CameraSource, Field, Inputs, NamedFile } from "../state/inputs.js";
import { ObjectModel, type ObjectParts } from "../state/object-model.js";
import type { RawView, Scene } from "../state/scene.js";
import { visibleExtent } from "../state/scene.js";
import { cameraOf, knownCamera, type ReadCamera, readDepthMap, viewOf } from "./depth-view.js";
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
  /** The size of the image to which the camera file belongs, if it says so. */
  cameraSize: ImageSize | null;
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
export type SceneReading = Omit<
  Reading,
  "focalUncertainty" | "cameraSize" | "size" | "shown" | "problems" | "depthKind"
>;

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
  const cameraBytes = cameraFile && (await attempt("camera", cameraFile, () => cameraFile.bytes()));
  const stated = cameraBytes && (await statedOf(cameraBytes, imageId));
  const integerDepthScale = stated?.depthScale;
  const depthScale = inputs.depthScale ?? undefined;
  const scales = { depthScale, integerDepthScale };
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
    size === null
      ? null
      : await attempt("camera", cameraFile, async () =>
          source === null
            ? cameraOf(
                { width: size.width, height: size.height, camera: read?.camera },
                photo && photoFile && { ...photo, bytes: await photoFile.bytes() },
              )
            : intrinsicsOf(source, cameraBytes, size, imageId),
        );
  const view = read && viewOf(read, camera);
  return {
    ...{ photo, objects, problems, size, shown, warnings: camera?.warnings ?? [] },
    depth: view && read && { data: view.depthM, width: read.width, height: read.height },
    raw: view?.raw ?? null,
    depthKind: read?.depthKind ?? "metric",
    depthUnit: read?.unit ?? null,
    camera: camera?.camera ?? null,
    cameraSource: camera?.source ?? null,
    focalUncertainty: camera?.focalUncertainty ?? 0,
    cameraSize: sizeOf(stated),
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

/** What a camera file says by itself. Errors are left to the reading of the intrinsics, which needs the image size. */
async function statedOf(camera: Uint8Array, imageId: string | null): Promise<CameraFile | null> {
  return readCamera(camera, imageId === null ? {} : { imageId }).catch(() => null);
}

/** The size of the image to which a camera file belongs, if it says so. */
const sizeOf = (stated: CameraFile | null): ImageSize | null =>
  stated?.width === undefined || stated.height === undefined ? null : { width: stated.width, height: stated.height };

const isSameSize = (a: ImageSize, b: ImageSize | null) => a.width === b?.width && a.height === b.height;

/** A vertical field of view that a pinhole camera can have, degrees. */
const FOV_RANGE = [1, 170] as const;

async function intrinsicsOf(
  source: CameraSource,
  bytes: Uint8Array | null,
  { width, height }: ImageSize,
  imageId: string | null,
): Promise<ReadCamera> {
  if (source.kind === "assumed") {
    const { fovYDeg } = source;
    if (!(fovYDeg >= FOV_RANGE[0] && fovYDeg <= FOV_RANGE[1])) {
      throw new Error(`The vertical field of view must be between ${FOV_RANGE[0]}° and ${FOV_RANGE[1]}°.`);
    }
    const warning = `The camera is assumed (vertical field of view ${fovYDeg}°), so the size is approximate.`;
    return { ...(await knownCamera({ fovYDeg }, { width, height })), warnings: [warning] };
  }
  if (source.kind === "numbers") return { camera: entered(source), source: null, focalUncertainty: 0, warnings: [] };
  if (bytes === null) throw new Error("The camera file could not be read.");
  return knownCamera(bytes, imageId === null ? { width, height } : { width, height, imageId });
}

/** Intrinsics that were typed. */
function entered({ fx, fy, cx, cy }: Extract<CameraSource, { kind: "numbers" }>): Scene["camera"] {
  if (fx === null || fy === null || cx === null || cy === null) {
    const missing = Object.entries({ fx, fy, cx, cy }).flatMap(([name, value]) => (value === null ? [name] : []));
    throw new Error(`Enter ${missing.join(", ")}, or choose a camera file.`);
  }
  if (!(fx > 0 && fy > 0)) throw new Error("fx and fy must be greater than 0: focal lengths in pixels.");
  return { fx, fy, cx, cy };
}

/** A pose in a file. It only serves for comparison, or as a candidate, so an unreadable file counts as a missing one. */
const truthOf = async (file: NamedFile | null): Promise<ObjectParts["truth"]> =>
  file && readPose(await file.bytes()).catch(() => null);
