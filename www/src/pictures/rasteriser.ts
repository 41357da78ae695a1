/** Renders depth maps of meshes, for the image view. */
import type { MeshArrays } from "sim3align";
import type { Scene } from "../state/scene.js";

/** Triangles with a nearer vertex are skipped instead of clipped: no depth camera measures there. */
const NEAR_M = 1e-3;

/** Projects points: u and v in pixels, and 1/z, which is linear in the image. 1/z is 0 for points that are too near. */
export function projected(
  positions: Float32Array,
  m: ArrayLike<number>,
  { fx, fy, cx, cy }: Scene["camera"],
): Float64Array {
  const at = (i: number) => m[i] ?? 0;
  const [m0, m1, m2, m4, m5, m6] = [at(0), at(1), at(2), at(4), at(5), at(6)];
  const [m8, m9, m10, m12, m13, m14] = [at(8), at(9), at(10), at(12), at(13), at(14)];
  const result = new Float64Array(positions.length);
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const [x, y, z] = [positions[i] as number, positions[i + 1] as number, positions[i + 2] as number];
    const depth = m2 * x + m6 * y + m10 * z + m14;
    const inverse = depth > NEAR_M ? 1 / depth : 0;
    result[i] = cx + fx * (m0 * x + m4 * y + m8 * z + m12) * inverse;
    result[i + 1] = cy + fy * (m1 * x + m5 * y + m9 * z + m13) * inverse;
    result[i + 2] = inverse;
  }
  return result;
}

/**
 * Renders the depth of a mesh.
 * @param matrix camera from mesh, 16 numbers, column-major
 * @returns z-depth in metres, 0 for pixels that show no mesh
 */
export function renderDepth(
  { positions, indices }: MeshArrays,
  matrix: ArrayLike<number>,
  { width, height, camera }: Pick<Scene, "width" | "height" | "camera">,
): Float32Array {
  const into = new Float32Array(width * height);
  const vertices = projected(positions, matrix, camera);
  const count = indices?.length ?? positions.length / 3;
  for (let t = 0; t + 2 < count; t += 3) {
    const a = 3 * (indices?.[t] ?? t);
    const b = 3 * (indices?.[t + 1] ?? t + 1);
    const c = 3 * (indices?.[t + 2] ?? t + 2);
    drawTriangle(vertices, a, b, c, width, height, into);
  }
  return into;
}

function drawTriangle(
  vertices: Float64Array,
  a: number,
  b: number,
  c: number,
  width: number,
  height: number,
  into: Float32Array,
): void {
  const [ua, va, wa] = [vertices[a] as number, vertices[a + 1] as number, vertices[a + 2] as number];
  const [ub, vb, wb] = [vertices[b] as number, vertices[b + 1] as number, vertices[b + 2] as number];
  const [uc, vc, wc] = [vertices[c] as number, vertices[c + 1] as number, vertices[c + 2] as number];
  if (wa === 0 || wb === 0 || wc === 0) return;
  const area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va);
  if (area === 0) return;
  const left = Math.max(0, Math.ceil(Math.min(ua, ub, uc)));
  const right = Math.min(width - 1, Math.floor(Math.max(ua, ub, uc)));
  const top = Math.max(0, Math.ceil(Math.min(va, vb, vc)));
  const bottom = Math.min(height - 1, Math.floor(Math.max(va, vb, vc)));
  for (let v = top; v <= bottom; v++) {
    for (let u = left; u <= right; u++) {
      const shareB = ((u - ua) * (vc - va) - (uc - ua) * (v - va)) / area;
      const shareC = ((ub - ua) * (v - va) - (u - ua) * (vb - va)) / area;
      const shareA = 1 - shareB - shareC;
      if (shareA < 0 || shareB < 0 || shareC < 0) continue;
      const depth = 1 / (shareA * wa + shareB * wb + shareC * wc);
      const pixel = v * width + u;
      const before = into[pixel] as number;
      if (before === 0 || depth < before) into[pixel] = depth;
    }
  }
}
