/** Files of 3D Gaussians, written independently of the package. */
import { Quaternion, Triangle, Vector3 } from "three";
import { Random } from "./random.js";
import type { Mesh } from "./scene.js";

/** A Gaussian; the quaternion is w, x, y, z, of any length. `harmonics` are those of red, green and blue from degree 1 on. */
export interface Gaussian {
  position: number[];
  scales: number[];
  rotation: number[];
  opacity: number;
  color: number[];
  harmonics: number[];
}

/** A PLY file of 3D Gaussian Splatting, with normals of (0, 0, 1) and a label of one byte. */
export function splatPly(gaussians: readonly Gaussian[]): Uint8Array {
  const rest = (gaussians[0]?.harmonics ?? []).map((_, i) => `f_rest_${i}`);
  const floats = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", ...rest];
  floats.push("opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3");
  const lines = ["ply", "format binary_little_endian 1.0", `element vertex ${gaussians.length}`];
  lines.push(...floats.map((name) => `property float ${name}`), "property uchar label", "end_header", "");
  const records = gaussians.map(({ position, scales, rotation, opacity, color, harmonics }, i) => {
    const dc = color.map((code) => (code / 255 - 0.5) / 0.28209479177387814);
    const logit = Math.log(opacity / (1 - opacity));
    const numbers = [...position, 0, 0, 1, ...dc, ...harmonics, logit, ...scales.map(Math.log), ...rotation];
    return Buffer.concat([Buffer.from(Float32Array.from(numbers).buffer), Buffer.from([i % 251])]);
  });
  return Uint8Array.from(Buffer.concat([Buffer.from(lines.join("\n"), "latin1"), ...records]));
}

/** A `.splat` file. */
export function splatRecords(gaussians: readonly Gaussian[]): Uint8Array {
  const records = gaussians.map(({ position, scales, rotation, opacity, color }) => {
    const length = Math.hypot(...rotation);
    const quaternion = rotation.map((q) => Math.min(255, Math.round((128 * q) / length + 128)));
    const codes = [...color, Math.round(255 * opacity), ...quaternion];
    return Buffer.concat([Buffer.from(Float32Array.from([...position, ...scales]).buffer), Buffer.from(codes)]);
  });
  return Uint8Array.from(Buffer.concat(records));
}

/** The Gaussians of a PLY file that {@link splatPly} wrote, with their normals and labels. */
export function gaussiansIn(file: Uint8Array): (Gaussian & { normal: number[]; label: number })[] {
  const text = Buffer.from(file).toString("latin1");
  const start = text.indexOf("end_header\n") + 11;
  const floats = text.slice(0, start).split("property float ").length - 1;
  const stride = 4 * floats + 1;
  return Array.from({ length: (file.length - start) / stride }, (_, i) => {
    const view = new DataView(file.buffer, file.byteOffset + start + i * stride, stride);
    const at = (from: number, count: number) =>
      Array.from({ length: count }, (_, k) => view.getFloat32(4 * (from + k), true));
    return {
      position: at(0, 3),
      normal: at(3, 3),
      color: at(6, 3).map((dc) => 255 * (0.5 + 0.28209479177387814 * dc)),
      harmonics: at(9, floats - 17),
      opacity: 1 / (1 + Math.exp(-(at(floats - 8, 1)[0] as number))),
      scales: at(floats - 7, 3).map(Math.exp),
      rotation: at(floats - 4, 4),
      label: view.getUint8(stride - 1),
    };
  });
}

/** The Gaussians of a `.splat` file. */
export const gaussiansInRecords = (file: Uint8Array): Gaussian[] =>
  Array.from({ length: file.length / 32 }, (_, i) => {
    const view = new DataView(file.buffer, file.byteOffset + 32 * i, 32);
    const numbers = Array.from({ length: 6 }, (_, k) => view.getFloat32(4 * k, true));
    const codes = Array.from({ length: 8 }, (_, k) => view.getUint8(24 + k));
    return {
      position: numbers.slice(0, 3),
      scales: numbers.slice(3),
      color: codes.slice(0, 3),
      opacity: (codes[3] ?? 0) / 255,
      rotation: codes.slice(4).map((code) => (code - 128) / 128),
      harmonics: [],
    };
  });

/** A flat Gaussian on each triangle of a mesh, and transparent ones around it. */
export function splatOf({ positions, indices }: Mesh): Gaussian[] {
  const random = new Random(1);
  const common = { opacity: 0.9, color: [200, 100, 50], harmonics: [] };
  const flat = Array.from({ length: indices.length / 3 }, (_, t): Gaussian => {
    const corners = [0, 1, 2].map((k) => new Vector3().fromArray(positions, 3 * (indices[3 * t + k] ?? 0)));
    const triangle = new Triangle(...(corners as [Vector3, Vector3, Vector3]));
    const { x, y, z, w } = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), triangle.getNormal(new Vector3()));
    const size = 0.7 * Math.sqrt(triangle.getArea());
    const position = triangle.getMidpoint(new Vector3()).toArray();
    return { ...common, position, scales: [size, size, size / 10], rotation: [w, x, y, z] };
  });
  const around = flat.slice(0, flat.length / 20).map((gaussian) => {
    return { ...gaussian, position: random.list(3, -2, 2), opacity: random.between(0.01, 0.2) };
  });
  return [...flat, ...around];
}
