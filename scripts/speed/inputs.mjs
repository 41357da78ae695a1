/** Inputs of speed measurements: modules of the package's sources, and synthetic objects of any size. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { compiledDir } from "../lib/paths.mjs";

/**
 * A module of the package's sources, of which the package holds only bundles.
 * @param {string} file
 */
export const compiledModule = (file) => import(pathToFileURL(join(compiledDir, file)).href);

/** @param {object} [options] */
export const createAligner = async (options) => (await compiledModule("index.js")).createAligner(options);

/**
 * The memory of a WebAssembly module of the package, in a new instance.
 * @param {"core" | "joint" | "registration"} name
 * @returns {Promise<WebAssembly.Memory>}
 */
export async function freshMemory(name) {
  const [{ wasmModules }, glue] = await Promise.all(["modules/modules.js", `wasm/${name}.js`].map(compiledModule));
  await wasmModules[name].load();
  glue.__wbg_reset_state();
  return (await glue.default()).memory;
}

/** @typedef {{ positions: Float32Array, indices: Uint32Array }} Mesh */

/**
 * A bumpy ring of about so many triangles: no two views of it are alike.
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
      const height = tube * Math.sin(v) + 0.05 * Math.sin(2 * u);
      positions.set([1.4 * radius * Math.cos(u), radius * Math.sin(u), height], 3 * at);
      const [right, down] = [((i + 1) % around) * across, (j + 1) % across];
      indices.set([at, right + j, right + down, at, right + down, i * across + down], 6 * at);
    }
  }
  return { positions, indices };
}

/**
 * The mesh, tilted, 0.6 m long, 1 m in front of the camera, before a wall at 2 m.
 * @param {Mesh} mesh
 * @param {number} width pixels
 * @param {number} height pixels
 * @param {number} [zoom] at 1 the object covers about half of the height
 */
export function pictureOf(mesh, width, height, zoom = 1) {
  const camera = { fx: zoom * height, fy: zoom * height, cx: (width - 1) / 2, cy: (height - 1) / 2 };
  const depth = new Float32Array(width * height).fill(2);
  const mask = new Uint8Array(width * height);
  const [scale, cosine, sine] = [0.65, Math.cos(0.6), Math.sin(0.6)];
  const corner = (/** @type {number} */ index) => {
    const [x = 0, y = 0, z = 0] = mesh.positions.subarray(3 * index, 3 * index + 3).map((value) => scale * value);
    const across = cosine * x + sine * z;
    const along = cosine * z - sine * x;
    const far = 1 + cosine * along + sine * y;
    return [camera.cx + (camera.fx * across) / far, camera.cy + (camera.fy * (cosine * y - sine * along)) / far, far];
  };
  for (let i = 0; i < mesh.indices.length; i += 3) {
    const [a = 0, b = 0, c = 0] = mesh.indices.subarray(i, i + 3);
    const [ua = 0, va = 0, za = 0] = corner(a);
    const [ub = 0, vb = 0, zb = 0] = corner(b);
    const [uc = 0, vc = 0, zc = 0] = corner(c);
    const area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va);
    if (area === 0) continue;
    for (let v = Math.max(Math.ceil(Math.min(va, vb, vc)), 0); v <= Math.min(Math.max(va, vb, vc), height - 1); v++) {
      for (let u = Math.max(Math.ceil(Math.min(ua, ub, uc)), 0); u <= Math.min(Math.max(ua, ub, uc), width - 1); u++) {
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
  return { depth, width, height, mask, camera, mesh };
}

/**
 * Bumpy rings side by side before a wall that counts as their support, so that every step of a scene runs.
 * @param {{ objects: number, triangles: number, width: number, height: number }} size
 */
export function sceneOf({ objects: count, triangles, width, height }) {
  const columns = Math.ceil(Math.sqrt(count));
  const [tileWidth, tileHeight] = [Math.floor(width / columns), Math.floor(height / Math.ceil(count / columns))];
  const depth = new Float32Array(width * height).fill(2);
  const camera = { fx: tileHeight, fy: tileHeight, cx: (width - 1) / 2, cy: (height - 1) / 2 };
  const objects = Array.from({ length: count }, (_, k) => {
    const tile = pictureOf(bumpyRing(triangles), tileWidth, tileHeight);
    const mask = new Uint8Array(width * height);
    for (let v = 0; v < tileHeight; v++) {
      const at = (v + Math.floor(k / columns) * tileHeight) * width + (k % columns) * tileWidth;
      depth.set(tile.depth.subarray(v * tileWidth, (v + 1) * tileWidth), at);
      mask.set(tile.mask.subarray(v * tileWidth, (v + 1) * tileWidth), at);
    }
    return { mask, mesh: tile.mesh };
  });
  return { depth, width, height, camera, objects, support: { normal: [0, 0, -1], d: 2 } };
}
