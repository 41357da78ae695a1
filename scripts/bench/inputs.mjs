/** Inputs of measurements as typed arrays: case folders, and generated pictures of any size. */
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { compiledDir, packageDir } from "../lib/paths.mjs";

/**
 * A module of the built package.
 * @param {string} file
 */
export const packageModule = (file) => import(pathToFileURL(join(packageDir, file)).href);

/**
 * A module of the package's sources, of which the package holds only bundles.
 * @param {string} file
 */
export const compiledModule = (file) => import(pathToFileURL(join(compiledDir, file)).href);

/** The names of the qualities, from the built package's table of options. @returns {Promise<string[]>} */
export async function qualities() {
  const { OPTIONS } = await packageModule("index.js");
  return OPTIONS.align.find((/** @type {{ name: string }} */ { name }) => name === "quality").choices;
}

/**
 * The folders that hold a file of this name: the given ones, and those in others.
 * @param {string} file
 * @param {readonly string[]} folders
 */
export function foldersWith(file, folders) {
  const isOne = (/** @type {string} */ folder) => existsSync(join(folder, file));
  return folders
    .map((folder) => resolve(folder))
    .flatMap((folder) => (isOne(folder) ? folder : within(folder).filter(isOne)));
}

/** What is in a folder, in the order of the names. @param {string} folder */
export const within = (folder) =>
  readdirSync(folder)
    .sort()
    .map((name) => join(folder, name));

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
  const [{ readCaseFolder }, { resolveInput }, { fileReaders }] = await Promise.all(
    ["case-folder.js", "input/resolve.js", "file-readers.js"].map(compiledModule),
  );
  const { name, input, truth } = await readCaseFolder(folder);
  const { core } = await resolveInput(input, fileReaders);
  const { depth, depthScale, width, height, mask, maskWidth, maskHeight, camera, mesh } = core;
  if ((maskWidth ?? width) !== width || (maskHeight ?? height) !== height) {
    throw new Error(`${folder}: the mask is not of the depth map's size. Remedy: resize it.`);
  }
  const metres = Float32Array.from(depth, (/** @type {number} */ z) => z * (depthScale ?? 1));
  const indices = Uint32Array.from(mesh.indices ?? mesh.positions.subarray(0, mesh.positions.length / 3).keys());
  return {
    name,
    input: { depth: metres, width, height, mask, camera, mesh: { positions: mesh.positions, indices } },
    truth: truth && { matrix: truth.transform.matrix, symmetry: declaredSymmetry(folder) ?? truth.symmetry },
  };
}

/**
 * The symmetry that a generated case declares, as an option of `evaluate`.
 * @param {string} folder
 */
function declaredSymmetry(folder) {
  const { symmetryAxes } = JSON.parse(readFileSync(join(folder, "gt.json"), "utf8"));
  if (!Array.isArray(symmetryAxes)) return null;
  return symmetryAxes.length === 0
    ? "none"
    : symmetryAxes.map(({ axis, fold }) => (Number.isInteger(fold) ? { axis, fold } : { axis }));
}

/** An aligner, and the memory of the core, in a new instance. */
export async function freshCore() {
  const { createAligner } = await compiledModule("index.js");
  const aligner = await createAligner();
  return { aligner, memory: await freshMemory("core") };
}

/**
 * The memory of a WebAssembly module of the package, in a new instance.
 * @param {"core" | "formats" | "joint" | "registration"} name
 * @returns {Promise<WebAssembly.Memory>}
 */
export async function freshMemory(name) {
  const files = [name === "core" ? "core.js" : `${name}-module.js`, `wasm/${name}.js`];
  const [loader, glue] = await Promise.all(files.map(compiledModule));
  await loader[`${name}Module`].load();
  glue.__wbg_reset_state();
  return (await glue.default()).memory;
}

/** @typedef {TypedCase["mesh"]} Mesh */

/**
 * A bumpy ring, which looks different from all sides, of about so many triangles.
 * @param {number} triangles
 * @returns {Mesh}
 */
export function bumpyRing(triangles) {
  const [around, across] = [Math.round(Math.sqrt(triangles)), Math.round(Math.sqrt(triangles) / 2)];
  const positions = new Float32Array(3 * around * across);
  const indices = new Uint32Array(6 * around * across);
  for (let i = 0; i < around; i++) {
    for (let j = 0; j < across; j++) {
      const [u, v] = [(2 * Math.PI * i) / around, (2 * Math.PI * j) / across];
      const tube = 0.12 + 0.04 * Math.sin(u) + 0.02 * Math.cos(3 * u + v);
      const radius = 0.3 + tube * Math.cos(v);
      const at = i * across + j;
      positions.set(
        [1.4 * radius * Math.cos(u), radius * Math.sin(u), tube * Math.sin(v) + 0.05 * Math.sin(2 * u)],
        3 * at,
      );
      const [right, down] = [((i + 1) % around) * across, (j + 1) % across];
      const corners = [at, right + j, right + down, at, right + down, i * across + down];
      indices.set(corners, 6 * at);
    }
  }
  return { positions, indices };
}

/**
 * The mesh, turned, about half as high as the image, 1 m away before a wall.
 * @param {Mesh} mesh
 * @param {number} width pixels
 * @param {number} height pixels
 * @param {number} [zoom] how many times as large; at 2 it fills the image
 * @returns {TypedCase}
 */
export function pictureOf(mesh, width, height, zoom = 1) {
  const camera = { fx: zoom * height, fy: zoom * height, cx: (width - 1) / 2, cy: (height - 1) / 2 };
  const depth = new Float32Array(width * height).fill(2);
  const mask = new Uint8Array(width * height);
  const { positions, indices } = mesh;
  const pixels = projected(positions, camera);
  for (let corner = 0; corner < indices.length; corner += 3) {
    const [a = 0, b = 0, c = 0] = indices.subarray(corner, corner + 3);
    drawTriangle(
      pixels.subarray(3 * a, 3 * a + 3),
      pixels.subarray(3 * b, 3 * b + 3),
      pixels.subarray(3 * c, 3 * c + 3),
    );
  }
  return { depth, width, height, mask, camera, mesh };

  /** @param {Float64Array} a @param {Float64Array} b @param {Float64Array} c each u, v, z */
  function drawTriangle([ua = 0, va = 0, za = 0], [ub = 0, vb = 0, zb = 0], [uc = 0, vc = 0, zc = 0]) {
    const area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va);
    if (area === 0) return;
    const [left, right] = [Math.ceil(Math.min(ua, ub, uc)), Math.floor(Math.max(ua, ub, uc))];
    const [top, bottom] = [Math.ceil(Math.min(va, vb, vc)), Math.floor(Math.max(va, vb, vc))];
    for (let v = Math.max(top, 0); v <= Math.min(bottom, height - 1); v++) {
      for (let u = Math.max(left, 0); u <= Math.min(right, width - 1); u++) {
        const wb = ((u - ua) * (vc - va) - (uc - ua) * (v - va)) / area;
        const wc = ((ub - ua) * (v - va) - (u - ua) * (vb - va)) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        const z = 1 / ((1 - wb - wc) / za + wb / zb + wc / zc);
        const pixel = v * width + u;
        if (z >= (depth[pixel] ?? 0)) continue;
        depth[pixel] = z;
        mask[pixel] = 1;
      }
    }
  }
}

/**
 * u, v and z of every vertex, at the pose that {@link pictureOf} promises.
 * @param {Float32Array} positions
 * @param {TypedCase["camera"]} camera
 */
function projected(positions, { fx, fy, cx, cy }) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3] ?? value, value);
    high[i % 3] = Math.max(high[i % 3] ?? value, value);
  });
  const middle = low.map((value, axis) => (value + (high[axis] ?? value)) / 2);
  const scale = 0.6 / Math.hypot(...low.map((value, axis) => (high[axis] ?? value) - value));
  const [cosine, sine] = [Math.cos(0.6), Math.sin(0.6)];
  const pixels = new Float64Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    const [x = 0, y = 0, z = 0] = middle.map((m, axis) => scale * ((positions[i + axis] ?? m) - m));
    const [turnedX, turnedZ] = [cosine * x + sine * z, cosine * z - sine * x];
    const [tiltedY, tiltedZ] = [cosine * y - sine * turnedZ, 1 + cosine * turnedZ + sine * y];
    pixels.set([cx + (fx * turnedX) / tiltedZ, cy + (fy * tiltedY) / tiltedZ, tiltedZ], i);
  }
  return pixels;
}
