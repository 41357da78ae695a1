/**
 * A second look where the answer is in doubt: at what exporters and cameras often get wrong (a mirrored mesh or image, a
 * scene around the object, textures upside down), and at depth that shows no object, or has speckle.
 */
import type { Alignment, Warning } from "../generated/types.js";
import type { CoreInput } from "../modules/core-input.js";
import { isTypedArray } from "../values/kinds.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import type { JobContext } from "./context.js";
import { largePart } from "./large-part.js";
import { DOUBT } from "./notes.js";
import { continuesPlane } from "./surrounding-plane.js";

/**
 * How much better the score of the mirror image is, where this explains the doubt. Of 48 real objects, most of which are nearly
 * their own mirror images, it is up to 0.05 better; of a mesh that was mirrored, 0.66.
 */
const BETTER_SHAPE = 0.2;

/**
 * The agreement of the colours with the photo below which the textures are in doubt; and that of textures that explain it better,
 * and by how much they must. Of 31 real objects, also with wrong textures and with photos that are too bright, too dark or some
 * pixels off, none whose textures were not upside down agrees by more than 0.39 once they are; of those whose were, half do.
 */
const DOUBTFUL_COLORS = 0.45;
const GOOD_COLORS = 0.45;
const BETTER_COLORS = 0.3;

const mirrorImage: Warning = {
  code: "MESH_LOOKS_MIRRORED",
  message:
    "The mirror image of the mesh fits the image far better: one of the two is mirrored. Front cameras, Kinect and some apps write mirrored images: if text in the photo is mirrored, flip depth, mask and photo from left to right, with cx = width − 1 − cx. Otherwise, the mesh is, as by an exporter that exchanges two axes: negate one coordinate of all its vertices and turn its triangles round, or export it again.",
};

const background: Warning = {
  code: "DEPTH_LOOKS_LIKE_BACKGROUND",
  message:
    "The depth in the mask continues the plane around it: the sensor sees through the object, as with glass and other transparent things, or the mask shows nothing, or its object is as flat as the plane. Check the mask, or complete the depth of transparent objects before the call.",
};

const flippedTexture: Warning = {
  code: "TEXTURE_LOOKS_FLIPPED",
  message:
    "The photo agrees far better with the textures of the mesh upside down: the second texture coordinate seems to run the other way, as by an exporter that mixes up the origins of images. Replace v by 1 − v, or export the mesh again.",
};

/** Difference of the depth of a pixel from the median of those around it, of which most agree, that makes it speckle. */
const SPECKLE = 0.02;

/** The share of the readings in a mask from which on speckle explains a poor agreement of the depth. Of 50 inputs without, it is 0. */
const SPECKLED = 0.005;

const speckle = (share: number): Warning => ({
  code: "DEPTH_HAS_SPECKLE",
  message: `${(100 * share).toFixed(1)} % of the readings in the mask are far from all their neighbours: this lowers the agreement of the depth, and the confidence, also of a right pose. Remove such readings, for example with a median filter of 3 × 3 pixels.`,
});

/** The share of the readings in the mask that are speckle. */
function speckled({ depth, mask, maskWidth, width, height }: CoreInput): number {
  const [w, h] = [Number(width), Number(height)];
  if (!isTypedArray<Float32Array>(depth, "Float32Array", "Uint16Array")) return 0;
  if (!isTypedArray<Uint8Array>(mask, "Uint8Array", "Uint8ClampedArray") || (maskWidth ?? w) !== w) return 0;
  let [readings, found] = [0, 0];
  for (let i = w + 1; i < w * (h - 1) - 1; i++) {
    const z = depth[i] as number;
    if (!(mask[i] !== 0 && z > 0) || i % w === 0 || i % w === w - 1) continue;
    readings += 1;
    const around = [i - w - 1, i - w, i - w + 1, i - 1, i + 1, i + w - 1, i + w, i + w + 1]
      .map((k) => depth[k] as number)
      .filter((other) => other > 0)
      .sort((a, b) => a - b);
    const middle = around[around.length >> 1] ?? z;
    const isFar = (other: number) => Math.abs(other - z) > SPECKLE * middle;
    const agree = around.filter((other) => Math.abs(other - middle) < SPECKLE * middle).length;
    if (around.length > 4 && agree > 4 && around.every(isFar)) found += 1;
  }
  return readings === 0 ? 0 : found / readings;
}

/** The alignment, with a warning where it is in doubt and the mesh is not if it is read in another way. */
export async function lookedAtAgain(
  found: Alignment,
  input: CoreInput,
  options: object,
  context: JobContext,
): Promise<Alignment> {
  const { id: _, samples, ...shape } = input.mesh;
  const searched = (mesh: CoreMesh, more: object) => context.another({ ...input, mesh }, { ...options, ...more });
  const isInDoubt = found.shapeConfidence < DOUBT;
  const share = isInDoubt ? speckled(input) : 0;
  const isSpeckled = share > SPECKLED;
  // The mesh is not in doubt for what the depth explains.
  const warnings = found.warnings.filter(({ code }) => !(isSpeckled && code === "MESH_DOUBTFUL"));
  if (isSpeckled) warnings.push(speckle(share));
  if (isInDoubt) {
    if (continuesPlane(input)) warnings.push(background);
    const other = await searched(mirrorOf(shape), { initial: undefined });
    const score = found.diagnostics.score + BETTER_SHAPE;
    if (other !== undefined && other.shapeConfidence > DOUBT && other.diagnostics.score > score)
      warnings.push(mirrorImage);
  }
  const isWhole = warnings.every(({ code }) => code !== "MESH_PARTS_LEFT_OUT");
  const large = isWhole && isInDoubt ? largePart(shape) : null;
  if (large !== null) {
    const message = `A part of the mesh is ${large} times as large as the rest, as the floor or the walls of a scene are. If the mask does not show it, pass the object alone.`;
    const known = warnings.findIndex(({ code }) => code === "MESH_DOUBTFUL");
    const [doubtful] = known < 0 ? [] : warnings.splice(known, 1);
    warnings.push({
      code: "MESH_DOUBTFUL",
      message: doubtful === undefined ? message : `${doubtful.message} ${message}`,
    });
  }
  const agreement = agreementOf(found) ?? DOUBTFUL_COLORS;
  if (samples?.flippedColors !== undefined && agreement < DOUBTFUL_COLORS) {
    // The shape is the same: the pose is near.
    const { scale, rotation, translation } = found;
    const near = { search: "local", initial: { scale, rotation, translation } };
    const other = await searched({ ...shape, samples: { ...samples, colors: samples.flippedColors } }, near);
    const turned = (other && agreementOf(other)) ?? agreement;
    if (turned > Math.max(GOOD_COLORS, agreement + BETTER_COLORS)) warnings.push(flippedTexture);
  }
  return { ...found, warnings };
}

/** The agreement of the colours with the photo; `undefined` if they were not compared. */
const agreementOf = ({ diagnostics: { color } }: Alignment): number | undefined =>
  color === undefined || color.verdict === "hidden" ? undefined : color.agreement;

/** The mesh with −x, by its shape alone. */
function mirrorOf({ positions, indices }: CoreMesh): CoreMesh {
  const moved = positions.map((x, i) => (i % 3 === 0 ? -x : x));
  const corners = indices ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  // The other two corners of a triangle change places, so that it still faces outward.
  return {
    positions: moved,
    indices: corners.map((_, i) => corners[i + (i % 3 === 1 ? 1 : i % 3 === 2 ? -1 : 0)] ?? 0),
  };
}
