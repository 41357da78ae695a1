/** What the compiler accepts and refuses of the conventions. It is compiled with the tests, and never run. */
import type { AlignInput, Alignment, Sim3 } from "sim3align";
import {
  applyToPoints,
  compose,
  cropInput,
  exportGlb,
  fromRle,
  fromSam3d,
  fromTensor,
  orientedBoundingBox,
  resizeInput,
  stretchMesh,
  toBop,
  toCocoRle,
  toCuboid,
  toFrame,
  toRowMajor,
  uprightMesh,
} from "sim3align/conventions";
import { applyPinhole, applyToObject3D, meshInputFromThree, transformFromObject3D } from "sim3align/three";
import { type BufferGeometry, type Group, InstancedMesh, Mesh, PerspectiveCamera, type SkinnedMesh } from "three";

declare const alignment: Alignment;
declare const floats: Float32Array;
declare const doubles: Float64Array;
declare const wholes: Uint16Array;
declare const bytes: Uint8Array;
const size = { width: 2, height: 2 };

/** Never called. */
export function accepted(): void {
  const row: Float64Array = toRowMajor(alignment);
  const both: Sim3 = compose(toFrame(alignment, "ros"), { matrix: row }, row);
  const [x, y, z]: [number, number, number] = toFrame(both, "opengl").translation;
  const [single, double]: [Float32Array, Float64Array] = [applyToPoints(both, floats), applyToPoints(both, doubles)];
  const text: string = toCocoRle({ data: bytes, ...size }).counts;
  const runs: readonly number[] = toCocoRle({ data: bytes, ...size }, { compressed: false }).counts;
  const mask: AlignInput["mask"] = fromRle({ size: [2, 2], counts: text });
  const other: AlignInput["mask"] = fromTensor({ data: bytes, dims: [1, 1, 2, 2] }, "mask");
  const depth: Uint16Array = resizeInput({ depth: { data: wholes, ...size } }, size).depth.data;
  const element = { rle: "1, 3", left: "0", top: "0", width: "2", height: "2" };
  fromRle(element, "cvat", size);
  fromSam3d({ scale: [[1, 1, 1]], rotation: floats, translation: [[[0, 0, 1]]] });
  const input: AlignInput = cropInput(
    {
      depth: { data: floats, ...size },
      mask: fromRle([1, 3, 0, 0, 1, 1], "cvat", size),
      camera: { K: [[1]] },
      mesh: bytes,
    },
    { left: 0, top: 0, width: 1, height: 1 },
  );
  const metres: number = orientedBoundingBox({ positions: floats }, alignment, { box: "minimal" }).sizeM[0];
  toCuboid(orientedBoundingBox({ positions: floats }, alignment), { front: "-x", up: "z" });
  const file: Uint8Array = exportGlb(bytes, alignment, { metrics: alignment.metrics });
  const straight: Uint8Array = uprightMesh({ positions: floats }, alignment, { glb: file }).mesh;
  const stretched: Uint8Array = stretchMesh(straight, { stretch: doubles });
  void stretched;
  void [x, y, z, single, double, runs, mask, other, depth, input, metres, toBop(alignment).entry.cam_R_m2c];
}

/** three.js' own classes fit, by their shape alone. Never called. */
export function acceptedOfThree(group: Group, skinned: SkinnedMesh, geometry: BufferGeometry): void {
  for (const source of [group, skinned, geometry, new Mesh(), new InstancedMesh(geometry, undefined, 3)]) {
    const input: AlignInput["mesh"] = meshInputFromThree(source);
    void input;
  }
  applyToObject3D(group, alignment, { camera: new PerspectiveCamera() });
  const pose: Sim3 = transformFromObject3D(skinned, { frame: "opencv" });
  applyPinhole(new PerspectiveCamera(), { fx: 1, fy: 1, cx: 0, cy: 0 }, { ...size, far: 10 });
  void pose;
}

/** Never called. */
export function refused(geometry: BufferGeometry): void {
  // @ts-expect-error no such frame
  toFrame(alignment, "blender");
  // @ts-expect-error at least one
  compose();
  // @ts-expect-error plain arrays are refused
  applyToPoints(alignment, [1, 2, 3]);
  // @ts-expect-error a scale is needed
  toRowMajor({ rotation: [0, 0, 0, 1], translation: [0, 0, 0] });
  // @ts-expect-error the size is needed
  toCocoRle({ data: bytes });
  // @ts-expect-error depth is no bytes
  resizeInput({ depth: { data: bytes, ...size } }, size);
  // @ts-expect-error no such box
  orientedBoundingBox({ positions: floats }, alignment, { box: "smallest" });
  // @ts-expect-error a geometry has no pose
  applyToObject3D(geometry, alignment);
  // @ts-expect-error the image's size is needed
  applyPinhole(new PerspectiveCamera(), { fx: 1, fy: 1, cx: 0, cy: 0 }, { near: 1 });
}
