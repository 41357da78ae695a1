import { BufferAttribute, BufferGeometry, Points, PointsMaterial } from "three";

/**
 * Returns a depth map as points in the frame of a three.js camera (y up, looking along −z).
 * @param {{ data: Float32Array, width: number }} depth metres
 * @param {{ data: Uint8Array }} mask its pixels are drawn brighter
 * @param {{ fx: number, fy: number, cx: number, cy: number }} pinhole
 */
export function depthCloud({ data, width }, mask, { fx, fy, cx, cy }) {
  const positions = [];
  const colours = [];
  data.forEach((z, pixel) => {
    if (!(z > 0)) return;
    const [u, v] = [pixel % width, Math.floor(pixel / width)];
    positions.push(((u - cx) * z) / fx, (-(v - cy) * z) / fy, -z);
    colours.push(...(mask.data[pixel] ? [0.1, 0.45, 0.8] : [0.04, 0.05, 0.07]));
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
  geometry.setAttribute("color", new BufferAttribute(Float32Array.from(colours), 3));
  return new Points(geometry, new PointsMaterial({ size: 1, sizeAttenuation: false, vertexColors: true }));
}
