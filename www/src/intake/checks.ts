/** What is missing, contradictory or implausible in the inputs of a scene. */
import type { PixelArray } from "sim3align";
import { doubtOfSize } from "sim3align/camera/pinhole";
import { otherSize, scaled } from "../input/depth-view.js";
import { baseName, folderOf } from "../input/files.js";
import { doubt, error, type Problem, type Remedy, withoutObject } from "../input/problems.js";
import type { Reading, ReadObject } from "../input/reading.js";
import { depthRange } from "../pictures/colours.js";
import { type Inputs, withInverted } from "../state/inputs.js";
import { visibleExtent } from "../state/scene.js";
import { isNamedPhoto, isUnassigned } from "./file-roles.js";

/** A typical vertical field of view of phones and laptops. */
export const ASSUMED_FOV_DEG = 50;

/** Median depths of scenes, metres. */
const PLAUSIBLE_DEPTH_M = [0.02, 80] as const;
/** Sizes of objects, metres. */
const PLAUSIBLE_SIZE_M = [0.002, 100] as const;
/** Vertical fields of view of cameras, degrees. */
const PLAUSIBLE_FOV_DEG = [4, 140] as const;
/** A mask with a larger share of the image shows no single object. */
const MOST_OF_IMAGE = 0.97;
/** A mask with a larger share of the image's border is mostly that of the background. */
const MOST_OF_BORDER = 0.8;
/** Ratios of width and height that differ more show different fields of view. */
const ASPECT_TOLERANCE = 0.02;

/** All problems: those of the readers, and those that only the whole shows. */
export function problemsOf(inputs: Inputs, reading: Reading): Problem[] {
  const depth = ofDepth(inputs, reading);
  // What a wrong depth map does to the objects is not their fault.
  const seen = depth.length === 0 ? reading : { ...reading, depth: null };
  return [
    ...reading.problems.map((one) =>
      one.field === "camera" && one.code === "SIZE_MISMATCH" ? stretched(one, reading) : one,
    ),
    ...unassigned(inputs),
    ...several(inputs),
    ...missing(inputs),
    ...guessed(inputs, reading),
    ...depth,
    ...ofCamera(reading),
    ...ofPhoto(reading),
    ...reading.objects.flatMap((object, i) => ofObject(inputs, seen, object, i)),
  ];
}

function missing({ depth, objects }: Inputs): Problem[] {
  return [
    ...(depth === null
      ? [error("depth", "Depth map missing. Choose a PNG, or the file that a depth camera or a model wrote.")]
      : []),
    ...(objects.some(({ mask }) => mask !== null)
      ? []
      : [error("mask", "Mask missing. Choose a PNG, NPY or COCO JSON file.")]),
    ...(objects.some(({ mesh }) => mesh !== null)
      ? []
      : [error("mesh", "Mesh missing. Choose a GLB, glTF, OBJ, PLY or STL file.")]),
  ];
}

/** Files of which nothing says what they are. */
function unassigned({ files }: Inputs): Problem[] {
  const unknown = files.filter(isUnassigned);
  if (unknown.length === 0) return [];
  const names = unknown.slice(0, 3).map(({ file }) => baseName(file.path));
  const more = unknown.length > names.length ? `, and ${unknown.length - names.length} more` : "";
  const leaveOut: Remedy = {
    title: "Leave out",
    apply: (inputs) => ({ ...inputs, files: inputs.files.filter((one) => !isUnassigned(one)) }),
  };
  const what = `${names.join(", ")}${more}: not used. Choose below what each file is.`;
  return [doubt("files", what, [leaveOut])];
}

/** Of several files in one folder for what is one file, one is used. */
function several({ files, camera, photo }: Inputs): Problem[] {
  const used = { camera: camera?.kind === "file" ? camera.file : null, photo };
  return (["camera", "photo"] as const).flatMap((role) => {
    const own = used[role];
    const isRival = ({ file, role: other }: (typeof files)[number]) =>
      other === role &&
      file !== own &&
      folderOf(file.path) === folderOf(own?.path ?? "") &&
      // Beside a photo by name, other pictures are something else.
      (role !== "photo" || isNamedPhoto(file) || own === null || !isNamedPhoto(own));
    const names = own === null ? [] : files.filter(isRival).map(({ file }) => baseName(file.path));
    return names.length === 0 ? [] : [doubt(role, `${baseName(own?.path ?? "")} is used, ${names.join(", ")} not.`)];
  });
}

/** The camera of an image of another shape, whose intrinsics cannot be scaled. */
function stretched(problem: Problem, { cameraSize: from, size: to }: Reading): Problem {
  if (from === null || to === null) return problem;
  const factors = [to.width / from.width, to.height / from.height].map((factor) => Number(factor.toPrecision(3)));
  const message = `The camera is that of an image of ${from.width} × ${from.height}, and this one is ${to.width} × ${to.height}: cropped or stretched (${factors[0]} in x, ${factors[1]} in y), so its intrinsics cannot be scaled. Choose the camera of this image.`;
  return { ...problem, message };
}

/** What was taken for granted, and decides about the sizes. */
function guessed({ depthKind: chosen }: Inputs, { cameraSource, depth, depthKind }: Reading): Problem[] {
  const assumed: Remedy = {
    title: `Use ${ASSUMED_FOV_DEG}° field of view`,
    apply: (inputs) => ({ ...inputs, camera: { kind: "assumed", fovYDeg: ASSUMED_FOV_DEG } }),
  };
  const right: Remedy = { title: "Near is bright", apply: (inputs) => ({ ...inputs, depthKind }) };
  const dark: Remedy = { title: "Near is dark", apply: (inputs) => ({ ...inputs, depthKind: "affine-invariant" }) };
  const looksRelative =
    "This looks like relative depth, as models draw it: mostly, near is bright. Sizes will have no unit until one is known.";
  const unknown =
    "No camera, and neither the depth file nor the photo states one: the focal length will be estimated together with the poses.";
  return [
    ...(depth !== null && chosen === null && depthKind !== "metric"
      ? [doubt("depth", looksRelative, [right, dark])]
      : []),
    ...(cameraSource === "estimate" ? [doubt("camera", unknown, [assumed])] : []),
  ];
}

const useScale = (title: string, depthScale: number): Remedy => ({
  title,
  apply: (inputs) => ({ ...inputs, depthScale }),
});

function ofDepth({ depthScale }: Inputs, { depth, raw }: Reading): Problem[] {
  if (depth === null) return [];
  const range = depthRange(depth.data);
  if (raw !== null && raw.depthKind !== "metric") {
    const isFlat = range === null || raw.depth.every((d) => d === raw.depth[0] || !Number.isFinite(d));
    return isFlat ? [error("depth", "The depth map has no relief: all of its values are equal.")] : [];
  }
  if (range === null) return [error("depth", "The depth map has no reading: every pixel is 0 or no number.")];
  const { medianM } = range;
  const [nearest, farthest] = PLAUSIBLE_DEPTH_M;
  // A unit that was chosen is believed.
  if (depthScale !== null || (medianM >= nearest && medianM <= farthest)) return [];
  const shown = Number(medianM.toPrecision(3));
  const keep = useScale("Keep metres", 1);
  return medianM > farthest
    ? [
        error("depth", `Half of the scene is beyond ${shown} m: the unit is probably millimetres.`, [
          useScale("Use millimetres", 0.001),
          keep,
        ]),
      ]
    : [
        error("depth", `Half of the scene is nearer than ${shown} m: the unit is probably wrong.`, [
          useScale("Use metres", 1),
        ]),
      ];
}

/** The vertical field of view, degrees. */
export const fovYDegOf = ({ fy }: { fy: number }, { height }: { height: number }): number =>
  (360 / Math.PI) * Math.atan(height / (2 * fy));

function ofCamera({ camera, cameraSize, depth }: Reading): Problem[] {
  if (camera === null || depth === null) return [];
  const fovDeg = fovYDegOf(camera, depth);
  const [narrow, wide] = PLAUSIBLE_FOV_DEG;
  const ofOtherSize = cameraSize === null ? doubtOfSize(camera, depth) : undefined;
  const factor = otherSize(camera, depth);
  const scale = (by: number): Remedy => ({
    title: `Scale by ${Number(by.toFixed(2))}`,
    apply: (inputs) => ({ ...inputs, camera: scaled(camera, by) }),
  });
  const rescaled = factor === null ? [] : [scale(factor)];
  return [
    ...(fovDeg < narrow || fovDeg > wide
      ? [
          doubt(
            "camera",
            `The vertical field of view is ${fovDeg.toFixed(1)}°. Are fx and fy in pixels of the depth map?`,
          ),
        ]
      : []),
    ...(ofOtherSize === undefined ? [] : [doubt("camera", ofOtherSize, rescaled)]),
  ];
}

function ofPhoto({ photo, depth }: Reading): Problem[] {
  if (photo === null || depth === null) return [];
  const ratio = (photo.width * depth.height) / (photo.height * depth.width);
  if (Math.abs(Math.log(ratio)) <= ASPECT_TOLERANCE) return [];
  const sizes = `${photo.width} × ${photo.height}, the depth map ${depth.width} × ${depth.height}`;
  const leaveOut: Remedy = { title: "Leave out the photo", apply: (inputs) => ({ ...inputs, photo: null }) };
  return [error("photo", `The photo is ${sizes}: they do not show the same view.`, [leaveOut])];
}

function ofObject(
  inputs: Inputs,
  { depth, camera, depthKind }: Reading,
  { mask, mesh }: ReadObject,
  i: number,
): Problem[] {
  const files = inputs.objects[i];
  if (files === undefined) return [];
  const leaveOut: Remedy = { title: "Leave it out", apply: withoutObject(i) };
  const several = inputs.objects.length > 1;
  const problems: Problem[] = [];
  if (files.mask === null && several) problems.push(error("mask", `No mask for ${files.name}.`, [leaveOut], i));
  if (files.mesh === null && several) problems.push(error("mesh", `No mesh for ${files.name}.`, [leaveOut], i));
  if (mask === null || depth === null) return problems;
  const { count, readings, border } = counted(mask, depth);
  const invert: Remedy = { title: "Invert it", apply: withInverted(i) };
  if (count === 0)
    return [...problems, error("mask", "The mask is empty: no pixel is marked.", several ? [leaveOut] : [], i)];
  if (count > MOST_OF_IMAGE * mask.length) {
    const all = "The mask covers the whole image. It should mark the object only.";
    return [...problems, error("mask", all, [invert], i)];
  }
  if (border > MOST_OF_BORDER) {
    const around = "The mask covers the border of the image: it seems to mark the background instead of the object.";
    problems.push(doubt("mask", around, [invert], i));
  }
  if (readings === 0) {
    return [...problems, error("mask", "No pixel of the mask has a depth reading.", several ? [leaveOut] : [], i)];
  }
  if (camera === null || mesh === null || depthKind !== "metric") return problems;
  const { sizeM } = visibleExtent(depth, mask, camera);
  const [smallest, largest] = PLAUSIBLE_SIZE_M;
  if (sizeM < smallest || sizeM > largest) {
    const size = sizeM < 1 ? `${Number((1000 * sizeM).toPrecision(2))} mm` : `${Number(sizeM.toPrecision(2))} m`;
    problems.push(doubt("depth", `${files.name} would be ${size} in size. Is the unit of the depth map right?`, [], i));
  }
  return problems;
}

/** The pixels of a mask, those with a depth reading, and the share of the image's border that they cover. */
function counted(mask: Uint8Array, { data, width, height }: PixelArray<Float32Array>) {
  let [count, readings, atBorder] = [0, 0, 0];
  for (let pixel = 0; pixel < mask.length; pixel++) {
    if (mask[pixel] === 0) continue;
    const [x, y] = [pixel % width, Math.floor(pixel / width)];
    count++;
    if ((data[pixel] as number) > 0) readings++;
    if (x === 0 || y === 0 || x === width - 1 || y === height - 1) atBorder++;
  }
  return { count, readings, border: atBorder / (2 * (width + height) - 4) };
}
