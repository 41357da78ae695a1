/** What the compiler accepts and refuses. It is compiled with the tests, and never run. */
import {
  type Aligner,
  type AlignInput,
  type Alignment,
  type AlignOptions,
  type AlignResult,
  createAligner,
  type ErrorCode,
  type Metrics,
  type PaperAlignment,
  type PaperOptions,
  type SceneInput,
  Sim3AlignError,
  type Tracker,
} from "sim3align";

declare const floats: Float32Array;
declare const bytes: Uint8Array;
declare const blob: Blob;
const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
const mesh = { positions: floats };

/** Never called. */
export async function accepted(aligner: Aligner): Promise<void> {
  const alignment: Alignment = await aligner.align({ depth: floats, width: 2, height: 2, mask: bytes, camera, mesh });
  const matrix: number[] = alignment.matrix;
  const [x, y, z, w]: [number, number, number, number] = alignment.rotation;
  const iou: number | null = alignment.metrics.iou;
  const total: number = alignment.diagnostics.timingsMs.total;
  const icp: number | undefined = alignment.diagnostics.timingsMs.icp;
  void [matrix, x, y, z, w, iou, total, icp];

  const input: AlignInput = { depth: blob, mask: blob, cameraFile: "{}", mesh: blob };
  const baseline: PaperAlignment = await aligner.align(input, { preset: "paper", guard: null, lockScale: false });
  const ratio: number = baseline.diagnostics.scaleRatio;
  const spelt: Alignment = await aligner.align(input, { preset: "precise", seed: undefined });
  void [ratio, spelt];
  const confidence: number = alignment.confidence;
  const others: number[][] = alignment.alternatives.map((alternative) => alternative.matrix);
  const doubtM: number | undefined = alignment.uncertainty?.distanceM;
  void [confidence, others, doubtM];
  const [seen] = alignment.alternatives;
  await aligner.align({} as AlignInput, { scale: 1, initial: alignment, search: "local" });
  await aligner.align({} as AlignInput, { scale: [0.1, 1], initial: seen ?? null, symmetry: "auto" });
  await aligner.align({} as AlignInput, { scale: "free", initial: { matrix }, quality: "best", workBudget: null });
  await aligner.align({} as AlignInput, { knownExtentM: 0.095, knownExtentAxis: "y" });
  await aligner.align({} as AlignInput, { cameraUp: [0, -1, 0], meshUp: [0, 1, 0], symmetry: [{ axis: [0, 1, 0] }] });

  const bare = await aligner.align(input, { metrics: false, quality: "fast" });
  const none: undefined = bare.metrics;
  const chosen: AlignOptions = { seed: 1 };
  const typed: Alignment = await aligner.align(input, chosen);
  const ofPaper: PaperOptions = { preset: "paper" };
  const typedOfPaper: PaperAlignment = await aligner.align(input, ofPaper);
  const without: AlignOptions<false> = { metrics: false };
  const bareToo: undefined = (await aligner.align(input, without)).metrics;
  const open: AlignOptions<boolean> = { metrics: Math.random() < 0.5 };
  const perhaps: Metrics | undefined = (await aligner.align(input, open)).metrics;
  for await (const { alignment } of aligner.alignAll([input], chosen)) void alignment?.metrics.iou;
  void [typed, typedOfPaper, bareToo];
  const either: AlignOptions | PaperOptions = chosen as AlignOptions | PaperOptions;
  const any: AlignResult = await aligner.align(input, either);
  void [none, perhaps, any];
  for await (const { alignment } of aligner.alignAll([input], { ordered: true })) void (alignment?.confidence ?? 0);
  for await (const { alignment } of aligner.alignAll([input], { preset: "paper", icp: "none" })) {
    void alignment?.metrics.iou;
    // @ts-expect-error the paper's method has no confidence
    void alignment?.confidence;
  }
  await aligner.align({ depth: bytes, mask: { size: [2, 2], counts: "04" }, camera: { K: [[1]] }, mesh: { bytes } });
  await aligner.align(
    { depth: bytes, mask: bytes, camera, mesh },
    { onProgress: ({ fraction }) => fraction.toFixed() },
  );
  await aligner.evaluate({} as AlignInput, alignment, { truth: alignment, symmetry: [{ axis: [0, 0, 1] }] });
  await aligner.evaluate({} as AlignInput, { matrix });
  await aligner.register(floats, new Float64Array(9), { scale: [1, 2] });
  await aligner.estimateSim3(floats, floats, new Uint32Array(6), { scale: "free" });
  await createAligner({ wasm: new URL("https://example.org/wasm/") });
  await createAligner({ wasm: { core: new Uint8Array(8) } });
  await createAligner({ createWorker: () => new Worker("worker.js", { type: "module" }) });
  using scoped = await createAligner();
  void scoped;
}

/** Never called. */
export async function refused(aligner: Aligner, tracker: Tracker, error: unknown): Promise<void> {
  // @ts-expect-error plain arrays are refused
  await aligner.align({ depth: [1, 2], width: 2, height: 1, mask: bytes, camera, mesh });
  // @ts-expect-error a point map has the depth in it
  await aligner.align({ pointMap: floats, depth: floats, width: 2, height: 2, mask: bytes, mesh });
  // @ts-expect-error misspelt
  await aligner.align({ depht: floats, width: 2, height: 2, mask: bytes, camera, mesh });
  // @ts-expect-error these are options of results with metrics
  await aligner.align({} as AlignInput, { metrics: false } satisfies AlignOptions);
  // @ts-expect-error all objects need the depth map
  await aligner.alignScene({} as SceneInput, { transfer: true });
  // @ts-expect-error a tracker has its mesh
  await tracker.next({ depth: bytes, mask: bytes, camera, mesh });
  // @ts-expect-error a worker has events
  await createAligner({ createWorker: () => ({ postMessage() {}, terminate() {} }) });
  // @ts-expect-error no such preset
  await aligner.align({} as AlignInput, { preset: "best" });
  // @ts-expect-error no such quality
  await aligner.align({} as AlignInput, { quality: "ultra" });
  // @ts-expect-error no such word
  await aligner.align({} as AlignInput, { scale: "fixed" });
  // @ts-expect-error bounds are an array
  await aligner.align({} as AlignInput, { scale: { min: 0.1, max: 1 } });
  // @ts-expect-error an option of preset "paper"
  await aligner.align({} as AlignInput, { guard: [0.5, 1.5] });
  // @ts-expect-error an option of preset "precise"
  await aligner.align({} as AlignInput, { preset: "paper", quality: "best" });
  // @ts-expect-error the paper's method has no confidence
  void (await aligner.align({} as AlignInput, { preset: "paper" })).confidence;
  // @ts-expect-error metrics were not asked for
  void (await aligner.align({} as AlignInput, { metrics: false })).metrics.iou;
  // @ts-expect-error a direction has three numbers
  await aligner.align({} as AlignInput, { cameraUp: [0, 1] });
  // @ts-expect-error no transform
  await aligner.align({} as AlignInput, { initial: { scale: 1 } });
  // @ts-expect-error an object, not a tuple
  await aligner.align({} as AlignInput, { symmetry: [[0, 1, 0]] });
  // @ts-expect-error a guard has two bounds
  await aligner.align({} as AlignInput, { preset: "paper", guard: [0.5] });
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
