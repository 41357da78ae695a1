/** What the compiler accepts and refuses. It is compiled with the tests, and never run. */
import {
  type Aligner,
  type AlignInput,
  type Alignment,
  createAligner,
  type ErrorCode,
  Sim3AlignError,
} from "sim3align";

declare const floats: Float32Array;
declare const bytes: Uint8Array;
declare const blob: Blob;
const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
const mesh = { positions: floats };

/** Never called. */
export async function accepted(aligner: Aligner): Promise<void> {
  const alignment: Alignment = await aligner.align({ depth: floats, width: 2, height: 2, mask: bytes, camera, mesh });
  const matrix: Float64Array = alignment.matrix;
  const [x, y, z, w]: [number, number, number, number] = alignment.rotation;
  const iou: number | null = alignment.metrics.iou;
  const total: number = alignment.timingsMs.total;
  const icp: number | undefined = alignment.timingsMs.icp;
  void [matrix, x, y, z, w, iou, total, icp];

  await aligner.align({ depth: blob, mask: blob, cameraFile: "{}", mesh: blob }, { preset: "paper", guard: null });
  const confidence: number | null = alignment.confidence;
  const others: Float64Array[] = alignment.alternatives.map((alternative) => alternative.matrix);
  const doubtM: number | undefined = alignment.uncertainty?.distanceM;
  void [confidence, others, doubtM];
  const [seen] = alignment.alternatives;
  await aligner.align({} as AlignInput, { scale: 1, initial: alignment, search: "local" });
  await aligner.align({} as AlignInput, { scale: [0.1, 1], initial: seen ?? null, symmetry: "auto-revolution" });
  await aligner.align({} as AlignInput, { scale: { min: 0.1, max: 1 }, initial: { matrix }, quality: "best" });
  await aligner.align({} as AlignInput, { knownExtentM: 0.095, knownExtentAxis: "y", lockScale: null });
  await aligner.align({} as AlignInput, { cameraUp: [0, -1, 0], meshUp: [0, 1, 0], symmetry: [{ axis: [0, 1, 0] }] });
  await aligner.align({} as AlignInput, (await aligner.defaults()).align);
  await aligner.align({ pointMap: floats, width: 2, height: 2, mask: bytes, mesh });
  await aligner.align({ depth: bytes, mask: { size: [2, 2], counts: "04" }, camera: { K: [[1]] }, mesh: { bytes } });
  await aligner.align(
    { depth: bytes, mask: bytes, camera, mesh },
    { onProgress: ({ fraction }) => fraction.toFixed() },
  );
  await aligner.evaluate({} as AlignInput, alignment, { truth: alignment, symmetry: [{ axis: [0, 0, 1] }] });
  await aligner.evaluate({} as AlignInput, { matrix });
  await aligner.register(floats, new Float64Array(9), { scale: [1, 2] });
  await aligner.estimateSim3(floats, floats, new Uint32Array(6), { scale: "fixed" });
  await createAligner({ wasm: new URL("https://example.org/core_bg.wasm") });
  using scoped = await createAligner();
  void scoped;
}

/** Never called. */
export async function refused(aligner: Aligner, error: unknown): Promise<void> {
  // @ts-expect-error plain arrays are refused
  await aligner.align({ depth: [1, 2], width: 2, height: 1, mask: bytes, camera, mesh });
  // @ts-expect-error depth needs a camera
  await aligner.align({ depth: floats, width: 2, height: 2, mask: bytes, mesh });
  // @ts-expect-error a point map has the depth in it
  await aligner.align({ pointMap: floats, depth: floats, width: 2, height: 2, mask: bytes, mesh });
  // @ts-expect-error misspelt
  await aligner.align({ depht: floats, width: 2, height: 2, mask: bytes, camera, mesh });
  // @ts-expect-error no such preset
  await aligner.align({} as AlignInput, { preset: "best" });
  // @ts-expect-error no such quality
  await aligner.align({} as AlignInput, { quality: "ultra" });
  // @ts-expect-error align leaves a free scale out
  await aligner.align({} as AlignInput, { scale: "free" });
  // @ts-expect-error a direction has three numbers
  await aligner.align({} as AlignInput, { cameraUp: [0, 1] });
  // @ts-expect-error no transform
  await aligner.align({} as AlignInput, { initial: { scale: 1 } });
  // @ts-expect-error an object, not a tuple
  await aligner.align({} as AlignInput, { symmetry: [[0, 1, 0]] });
  // @ts-expect-error no such option
  await aligner.align({} as AlignInput, { voxelDivision: 30 });
  // @ts-expect-error a guard has two bounds
  await aligner.align({} as AlignInput, { guard: [0.5] });
  // @ts-expect-error correspondences are a Uint32Array
  await aligner.estimateSim3(floats, floats, [0, 0]);
  // @ts-expect-error no such scale
  await aligner.register(floats, floats, { scale: "loose" });
  if (error instanceof Sim3AlignError) {
    const code: ErrorCode = error.code;
    // @ts-expect-error no such code
    if (code === "OOPS") return;
  }
}
