/** Case folders as typed arrays, so that nobody's time is spent on files. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { packageModule } from "./package.mjs";

/**
 * @typedef {object} TypedCase
 * @property {Float32Array} depth metres
 * @property {number} width
 * @property {number} height
 * @property {Uint8Array} mask
 * @property {{ fx: number, fy: number, cx: number, cy: number }} camera
 * @property {{ positions: Float32Array, indices: Uint32Array }} mesh
 */

/** @typedef {{ matrix: number[], symmetry: unknown }} Truth */

/**
 * Reads a case folder.
 * @param {string} folder
 * @returns {Promise<{ name: string, input: TypedCase, truth: Truth | null }>}
 */
export async function readTypedCase(folder) {
  const [{ readCaseFolder }, { resolveInput }, { formatsModule }] = await Promise.all(
    ["case-folder.js", "input/resolve.js", "formats-module.js"].map(packageModule),
  );
  const { name, input, truth } = await readCaseFolder(folder);
  const { core } = await resolveInput(input, () => formatsModule.load());
  const { depth, depthScale, width, height, mask, maskWidth, maskHeight, camera, mesh } = core;
  if ((maskWidth ?? width) !== width || (maskHeight ?? height) !== height) {
    throw new Error(`${folder}: the mask is not of the depth map's size. Remedy: resize it.`);
  }
  const metres = Float32Array.from(depth, (/** @type {number} */ z) => z * (depthScale ?? 1));
  const indices = Uint32Array.from(mesh.indices ?? mesh.positions.subarray(0, mesh.positions.length / 3).keys());
  return {
    name,
    input: { depth: metres, width, height, mask, camera, mesh: { positions: mesh.positions, indices } },
    truth: truth && {
      matrix: Array.from(truth.transform.matrix),
      symmetry: declaredSymmetry(folder) ?? truth.symmetry,
    },
  };
}

/**
 * What a generated case says of its object's symmetry, as `evaluate` takes it.
 * @param {string} folder
 */
function declaredSymmetry(folder) {
  const { symmetryAxes } = JSON.parse(readFileSync(join(folder, "gt.json"), "utf8"));
  if (!Array.isArray(symmetryAxes)) return null;
  return symmetryAxes.length === 0
    ? "none"
    : symmetryAxes.map(({ axis, fold }) => (Number.isInteger(fold) ? { axis, fold } : { axis }));
}
