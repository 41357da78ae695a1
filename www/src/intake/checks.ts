/** What is missing or contradictory in the inputs of a scene. What is only implausible, the alignment warns of. */

import type { ImageSize } from "sim3align/values/pixels";
import { baseName, folderOf } from "../input/files.js";
import { doubt, error, type Problem, type Remedy, withoutObject } from "../input/problems.js";
import type { Reading, ReadObject } from "../input/reading.js";
import { type Inputs, withInverted } from "../state/inputs.js";
import { isNamedPhoto, isUnassigned } from "./file-roles.js";

/** A typical vertical field of view of phones and laptops. */
export const ASSUMED_FOV_DEG = 50;

/** A mask with a larger share of the image's border is mostly that of the background. */
const MOST_OF_BORDER = 0.8;
/** Ratios of width and height that differ more show different fields of view. */
const ASPECT_TOLERANCE = 0.02;

/** All problems: those of the readers, and those that only the whole shows. */
export function problemsOf(inputs: Inputs, reading: Reading): Problem[] {
  const depth = ofDepth(reading);
  // What a wrong depth map does to the objects is not their fault.
  const seen = depth.length === 0 ? reading : { ...reading, depth: null };
  return [
    ...reading.problems.map(withRemedies),
    ...unassigned(inputs),
    ...several(inputs),
    ...missing(inputs),
    ...guessed(inputs, reading),
    ...depth,
    ...ofPhoto(reading),
    ...reading.objects.flatMap((object, i) => ofObject(inputs, seen, object, i)),
  ];
}

/** The problems of the readers with what a button can do. */
function withRemedies(problem: Problem): Problem {
  if (problem.field !== "depth" || !problem.message.includes("below 0")) return problem;
  const flip: Remedy = { title: "Flip the sign", apply: (inputs) => ({ ...inputs, depthScale: -1 }) };
  return { ...problem, remedies: [flip] };
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

function ofDepth({ depth, raw }: Reading): Problem[] {
  if (depth === null) return [];
  if (raw !== null && raw.depthKind !== "metric") {
    const isFlat = raw.depth.every((d) => d === raw.depth[0] || !Number.isFinite(d));
    return isFlat ? [error("depth", "The depth map has no relief: all of its values are equal.")] : [];
  }
  const hasReading = depth.data.some((z) => z > 0 && Number.isFinite(z));
  return hasReading ? [] : [error("depth", "The depth map has no reading: every pixel is 0 or no number.")];
}

/** The vertical field of view, degrees. */
export const fovYDegOf = ({ fy }: { fy: number }, { height }: { height: number }): number =>
  (360 / Math.PI) * Math.atan(height / (2 * fy));

function ofPhoto({ photo, depth }: Reading): Problem[] {
  if (photo === null || depth === null) return [];
  const ratio = (photo.width * depth.height) / (photo.height * depth.width);
  const isAlike = Math.abs(Math.log(ratio)) <= ASPECT_TOLERANCE;
  if (isAlike && !photo.isAsTaken) return [];
  const sizes = `${photo.width} × ${photo.height}, the depth map ${depth.width} × ${depth.height}`;
  if (isAlike) {
    const turned = "The photo's EXIF data turn it, but the depth map is not turned: the photo is used as it was taken.";
    return [doubt("photo", turned)];
  }
  const leaveOut: Remedy = { title: "Leave out the photo", apply: (inputs) => ({ ...inputs, photo: null }) };
  return [error("photo", `The photo is ${sizes}: they do not show the same view.`, [leaveOut])];
}

function ofObject(inputs: Inputs, { depth }: Reading, { mask }: ReadObject, i: number): Problem[] {
  const files = inputs.objects[i];
  if (files === undefined) return [];
  const leaveOut: Remedy = { title: "Leave it out", apply: withoutObject(i) };
  const several = inputs.objects.length > 1;
  const remedies = several ? [leaveOut] : [];
  const problems: Problem[] = [];
  if (files.mask === null && several) problems.push(error("mask", `No mask for ${files.name}.`, remedies, i));
  if (files.mesh === null && several) problems.push(error("mesh", `No mesh for ${files.name}.`, remedies, i));
  if (mask === null || depth === null) return problems;
  if (!mask.some((inside) => inside !== 0)) {
    problems.push(error("mask", "The mask is empty: no pixel is marked.", remedies, i));
  } else if (borderShare(mask, depth) > MOST_OF_BORDER) {
    const around = "The mask covers the border of the image: it seems to mark the background instead of the object.";
    problems.push(doubt("mask", around, [{ title: "Invert it", apply: withInverted(i) }], i));
  } else if (!mask.some((inside, pixel) => inside !== 0 && (depth.data[pixel] as number) > 0)) {
    problems.push(error("mask", "No pixel of the mask has a depth reading.", remedies, i));
  }
  return problems;
}

/** The share of the image's border that a mask covers. */
function borderShare(mask: Uint8Array, { width, height }: ImageSize): number {
  let count = 0;
  for (let x = 0; x < width; x++) {
    for (const y of [0, height - 1]) if (mask[y * width + x] !== 0) count++;
  }
  for (let y = 1; y < height - 1; y++) {
    for (const x of [0, width - 1]) if (mask[y * width + x] !== 0) count++;
  }
  return count / (2 * (width + height) - 4);
}
