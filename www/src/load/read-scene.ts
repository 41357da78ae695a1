/** Reads the input files of a scene. */
import { type MeshArrays, Sim3AlignError } from "sim3align";
import { resizeMask } from "sim3align/conventions";
import { externalResources, readCamera, readDepth, readMask, readMesh, readPose } from "sim3align/formats";
import { ObjectModel, type ObjectParts } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { FieldError, forField } from "./field-error.js";
import { baseName, extension, type NamedFile, stem } from "./files.js";
import { type CameraSource, type Inputs, type MeshSource, matchingFile } from "./inputs.js";
import { visibleExtent } from "./visible-extent.js";

/** Colours of objects, distinguishable on light and dark backgrounds and with most colour vision deficiencies. */
const colours = ["#f08a24", "#3c9ee5", "#2fa36b", "#c65fd0", "#d64545", "#a58a00"];

/**
 * Reads all inputs.
 * @throws {@link FieldError} for the first missing or invalid input
 */
export async function readScene(inputs: Inputs): Promise<Scene> {
  const { depth: depthFile, camera: cameraSource } = inputs;
  const depthSource = required("depth", depthFile, "Choose a 16-bit PNG or an NPY file.");
  const camera = required("camera", cameraSource, "Choose a file, or enter intrinsics or a field of view.");
  if (inputs.masks.length === 0) required("mask", null, "Choose a PNG, NPY, or COCO RLE (JSON) file.");
  if (inputs.meshes.length === 0) required("mesh", null, "Choose a GLB, glTF, OBJ, PLY or STL file.");

  // The camera file may state the unit of an integer depth map.
  const cameraBytes = camera.kind === "file" ? await forField("camera", () => camera.file.bytes()) : null;
  const integerDepthScale = await depthScaleOf(cameraBytes);
  const depth = await forField("depth", async () =>
    readDepth(await depthSource.bytes(), { depthScale: inputs.depthScale ?? undefined, integerDepthScale }),
  );
  const { width, height } = depth;
  const [{ warnings, ...intrinsics }, rgba, objects] = await Promise.all([
    forField("camera", () => intrinsicsOf(camera, cameraBytes, width, height)),
    inputs.photo === null ? null : forField("photo", () => readPhoto(inputs.photo as NamedFile, width, height)),
    readObjects(inputs, width, height),
  ]);
  return {
    name: inputs.name,
    sample: inputs.sample,
    depthM: depth.data,
    width,
    height,
    camera: intrinsics,
    rgba,
    objects: objects.map(
      (parts) => new ObjectModel({ ...parts, visible: visibleExtent(depth, parts.mask, intrinsics) }),
    ),
    warnings,
  };
}

function required<T>(field: FieldError["field"], value: T | null, remedy: string): T {
  if (value !== null) return value;
  throw new FieldError(field, new Error(`Missing. ${remedy}`));
}

/** The depth scale of a camera file. Errors are left to the reading of the intrinsics, which needs the image size. */
async function depthScaleOf(camera: Uint8Array | null): Promise<number | undefined> {
  if (camera === null) return undefined;
  return readCamera(camera).then(
    ({ depthScale }) => depthScale,
    () => undefined,
  );
}

type Intrinsics = Scene["camera"] & { warnings: readonly string[] };

async function intrinsicsOf(
  source: CameraSource,
  bytes: Uint8Array | null,
  width: number,
  height: number,
): Promise<Intrinsics> {
  if (source.kind === "assumed") {
    const { fx, fy, cx, cy } = await readCamera({ fovYDeg: source.fovYDeg }, { width, height });
    const warning = `The camera is assumed (vertical field of view ${source.fovYDeg}°), so the size is approximate.`;
    return { fx, fy, cx, cy, warnings: [warning] };
  }
  const { fx, fy, cx, cy, warnings } =
    source.kind === "numbers" ? { ...source, warnings: [] } : await readCamera(bytes as Uint8Array, { width, height });
  return { fx, fy, cx, cy, warnings };
}

async function readObjects(inputs: Inputs, width: number, height: number): Promise<Omit<ObjectParts, "visible">[]> {
  const meshes = new Map<MeshSource, Promise<{ mesh: MeshArrays; glb: Uint8Array | null }>>();
  const meshOf = (source: MeshSource) => {
    const found = meshes.get(source) ?? forField("mesh", () => readMeshSource(source));
    meshes.set(source, found);
    return found;
  };
  const several = inputs.masks.length > 1;
  return Promise.all(
    inputs.masks.map(async (file, i) => {
      const source = matchingFile(file, inputs.meshes, ({ file }) => file.path);
      if (source === undefined) {
        throw new FieldError(
          "mesh",
          new Error(
            `No mesh matches ${baseName(file.path)}. Give both files the same suffix: mask-cup.png, mesh-cup.glb.`,
          ),
        );
      }
      const [mask, mesh, truth] = await Promise.all([
        forField("mask", () => readMaskAt(file, width, height, inputs.resizeMasks)),
        meshOf(source),
        readTruth(matchingFile(file, inputs.truths, ({ path }) => path)),
      ]);
      const name = file.title ?? nameOf(file.path, several ? `Object ${i + 1}` : inputs.name);
      return { id: `${i}`, name, colour: colours[i % colours.length] ?? "#f08a24", mask, ...mesh, truth };
    }),
  );
}

/** The name of an object from the path of its mask: `mask-cup.png` and `cup/mask.png` are both "cup". */
function nameOf(path: string, otherwise: string): string {
  const own = stem(path).replace(/^masks?[-_ ]*/i, "");
  return own || path.split("/").at(-2) || otherwise;
}

async function readMaskAt(file: NamedFile, width: number, height: number, resize: boolean): Promise<Uint8Array> {
  const mask = await readMask(await file.bytes());
  if (mask.width === width && mask.height === height) return mask.data;
  if (resize) return resizeMask(mask, { width, height }).data as Uint8Array;
  throw new Sim3AlignError({
    code: "SIZE_MISMATCH",
    argument: "mask",
    found: `${mask.width} × ${mask.height} pixels`,
    expected: `${width} × ${height}, the size of the depth map`,
    remedy: "Export the mask at the size of the depth map, or select “Resize masks”.",
  });
}

async function readMeshSource({ file, siblings }: MeshSource): Promise<{ mesh: MeshArrays; glb: Uint8Array | null }> {
  const bytes = await file.bytes();
  const ending = extension(file.path);
  if (ending !== "gltf" && ending !== "obj") {
    return { mesh: await readMesh(bytes), glb: ending === "glb" ? bytes : null };
  }
  const resources: Record<string, Uint8Array> = {};
  const addResources = async (file: Uint8Array) => {
    const { shape, colors } = await externalResources(file);
    for (const name of [...shape, ...colors].filter((name) => !(name in resources))) {
      const found = siblings.find(({ path }) => path.endsWith(decoded(name)));
      if (found === undefined) continue;
      const content = await found.bytes();
      resources[name] = content;
      // The material libraries of an OBJ refer to textures.
      if (name.endsWith(".mtl")) await addResources(content);
    }
  };
  await addResources(bytes);
  return { mesh: await readMesh(bytes, { format: ending, resources }), glb: null };
}

/** A name in a mesh file, which may be a URI. */
function decoded(name: string): string {
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}

/** The true pose. It only serves for comparison, so an unreadable file counts as a missing one. */
async function readTruth(file: NamedFile | undefined): Promise<ObjectParts["truth"]> {
  if (file === undefined) return null;
  return readPose(await file.bytes()).catch(() => null);
}

/** The pixels of a photo, decoded by the browser and resized: red, green, blue, alpha. */
async function readPhoto(file: NamedFile, width: number, height: number): Promise<Uint8ClampedArray> {
  const blob = new Blob([Uint8Array.from(await file.bytes())]);
  const bitmap = await createImageBitmap(blob).catch(() => {
    throw new Error("The browser cannot decode this image. Choose a JPEG, PNG or WebP file.");
  });
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("The browser could not create a canvas for the photo.");
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return context.getImageData(0, 0, width, height).data;
}
