/** From files to a scene. */
import { type MeshArrays, Sim3AlignError } from "sim3align";
import { resizeMask } from "sim3align/conventions";
import { externalResources, readCamera, readDepth, readMask, readMesh, readPose } from "sim3align/formats";
import { ObjectModel, type ObjectParts } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { FieldError, forField } from "./field-error.js";
import { readPhoto } from "./image.js";
import { type CameraSource, type Inputs, type MeshSource, partner } from "./inputs.js";
import { baseName, extension, type NamedFile, stem } from "./named-file.js";
import { seenThrough } from "./seen.js";

/** Colours of objects, told apart by most people, on light and dark. */
const colours = ["#f08a24", "#3c9ee5", "#2fa36b", "#c65fd0", "#d64545", "#a58a00"];

/**
 * Reads everything.
 * @throws {@link FieldError} for the first input that is missing or wrong
 */
export async function readScene(inputs: Inputs): Promise<Scene> {
  const { depth: depthFile, camera: cameraSource } = inputs;
  const depthSource = given("depth", depthFile, "a depth map (PNG with 16 bits, or NPY)");
  const camera = given("camera", cameraSource, "a camera: a file, numbers, or a guess of its field of view");
  if (inputs.masks.length === 0) given("mask", null, "a mask (PNG, NPY, or COCO RLE as JSON)");
  if (inputs.meshes.length === 0) given("mesh", null, "a mesh (GLB, glTF, OBJ, PLY or STL)");

  // The camera file may say what whole numbers in the depth map mean.
  const cameraBytes = camera.kind === "file" ? await forField("camera", () => camera.file.bytes()) : null;
  const integerDepthScale = await statedDepthScale(cameraBytes);
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
    objects: objects.map((parts) => new ObjectModel({ ...parts, seen: seenThrough(depth, parts.mask, intrinsics) })),
    warnings,
  };
}

function given<T>(field: FieldError["field"], value: T | null, what: string): T {
  if (value !== null) return value;
  throw new FieldError(field, new Error(`Still to be chosen: ${what}.`));
}

/** The first reading is for the scale only; what is wrong with the file, the second one says. */
async function statedDepthScale(camera: Uint8Array | null): Promise<number | undefined> {
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
  if (source.kind === "guess") {
    const { fx, fy, cx, cy } = await readCamera({ fovYDeg: source.fovYDeg }, { width, height });
    const warning = `The camera is a guess (vertical field of view ${source.fovYDeg}°): the size will be about right at best.`;
    return { fx, fy, cx, cy, warnings: [warning] };
  }
  const { fx, fy, cx, cy, warnings } =
    source.kind === "numbers" ? { ...source, warnings: [] } : await readCamera(bytes as Uint8Array, { width, height });
  return { fx, fy, cx, cy, warnings };
}

async function readObjects(inputs: Inputs, width: number, height: number): Promise<Omit<ObjectParts, "seen">[]> {
  const meshes = new Map<MeshSource, Promise<{ mesh: MeshArrays; glb: Uint8Array | null }>>();
  const meshOf = (source: MeshSource) => {
    const found = meshes.get(source) ?? forField("mesh", () => readMeshSource(source));
    meshes.set(source, found);
    return found;
  };
  const several = inputs.masks.length > 1;
  return Promise.all(
    inputs.masks.map(async (file, i) => {
      const source = partner(file, inputs.meshes, ({ file }) => file.path);
      if (source === undefined) {
        throw new FieldError("mesh", new Error(`No mesh belongs to ${baseName(file.path)}: name them alike.`));
      }
      const [mask, mesh, truth] = await Promise.all([
        forField("mask", () => readMaskAt(file, width, height, inputs.resizeMasks)),
        meshOf(source),
        readTruth(partner(file, inputs.truths, ({ path }) => path)),
      ]);
      const name = file.title ?? nameOf(file.path, several ? `Object ${i + 1}` : inputs.name);
      return { id: `${i}`, name, colour: colours[i % colours.length] ?? "#f08a24", mask, ...mesh, truth };
    }),
  );
}

/** A name from a mask's path: `mask-cup.png` and `cup/mask.png` are of a cup. */
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
    expected: `the depth map's ${width} × ${height}`,
    remedy: "Export the mask at the depth map's size, or tick “resize masks”.",
  });
}

async function readMeshSource({ file, beside }: MeshSource): Promise<{ mesh: MeshArrays; glb: Uint8Array | null }> {
  const bytes = await file.bytes();
  const ending = extension(file.path);
  if (ending !== "gltf") return { mesh: await readMesh(bytes), glb: ending === "glb" ? bytes : null };
  const resources: Record<string, Uint8Array> = {};
  for (const uri of await externalResources(bytes)) {
    const found = beside.find(({ path }) => path.endsWith(decodeURIComponent(uri)));
    if (found !== undefined) resources[uri] = await found.bytes();
  }
  return { mesh: await readMesh(bytes, { format: "gltf", resources }), glb: null };
}

/** A true pose. It is only compared with: a file that cannot be read is as good as none. */
async function readTruth(file: NamedFile | undefined): Promise<ObjectParts["truth"]> {
  if (file === undefined) return null;
  return readPose(await file.bytes()).catch(() => null);
}
