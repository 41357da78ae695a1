/** Which inputs compile, and which do not. */
import type { Aligner, AlignInput, CameraInput, DepthInput } from "sim3align";

declare const aligner: Aligner;
declare const floats: Float32Array;
declare const bytes: Uint8Array;
declare const anyDepth: DepthInput;
declare const anyCamera: CameraInput;
const mesh = { positions: floats };
const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
const size = { width: 2, height: 2 };
const object = { mask: bytes, mesh };

export async function accepted(): Promise<void> {
  await aligner.align({ ...object, depth: floats, ...size, camera });
  await aligner.align({ ...object, depth: { data: floats, ...size }, camera: { ...camera, ...size } });
  await aligner.align({ ...object, depth: bytes, camera: { K: [[1]] } });
  await aligner.align({ ...object, depth: bytes, camera: { fovYDeg: 50 } });
  await aligner.align({ ...object, depth: anyDepth, ...size, camera: anyCamera });
  await aligner.align({ ...object, depth: bytes, cameraFile: "{}" });
  await aligner.align({ ...object, depth: bytes, cameraFile: { cam_K: [] }, imageId: 3 });
  await aligner.align({ ...object, pointMap: floats, ...size });
  await aligner.align({ ...object, pointMap: { data: floats, ...size }, camera });
  const declared: AlignInput = { ...object, depth: floats, ...size, camera };
  await aligner.align({ ...declared, resizeMask: "nearest" });
}

export async function refused(): Promise<void> {
  // @ts-expect-error a bare array needs its size
  await aligner.align({ ...object, depth: floats, camera });
  // @ts-expect-error height is missing
  await aligner.align({ ...object, depth: floats, width: 2, camera });
  // @ts-expect-error a point map as a bare array needs its size, too
  await aligner.align({ ...object, pointMap: floats, width: 2 });
  // @ts-expect-error cy is missing
  await aligner.align({ ...object, depth: bytes, camera: { fx: 1, fy: 1, cx: 0 } });
  // @ts-expect-error one form of intrinsics at a time
  await aligner.align({ ...object, depth: bytes, camera: { ...camera, fovYDeg: 50 } });
  // @ts-expect-error the content of a camera file is a cameraFile
  await aligner.align({ ...object, depth: bytes, camera: { cam_K: [] } });
  // @ts-expect-error text is a cameraFile
  await aligner.align({ ...object, depth: bytes, camera: "{}" });
  // @ts-expect-error one of the two
  await aligner.align({ ...object, depth: bytes, camera, cameraFile: "{}" });
  // @ts-expect-error an image id belongs to a camera file
  await aligner.align({ ...object, depth: bytes, camera, imageId: 3 });
  await aligner.align({ ...object, depth: bytes });
  await aligner.align({ ...object, depth: bytes, camera: { width: 2, height: 2 }, depthKind: "affine-invariant" });
  // @ts-expect-error no such kind
  await aligner.align({ ...object, depth: bytes, depthKind: "relative" });
  // @ts-expect-error the points of an affine-invariant map have no shape
  await aligner.align({
    ...object,
    pointMap: { data: new Float32Array(12), width: 2, height: 2 },
    depthKind: "affine-invariant",
  });
}
