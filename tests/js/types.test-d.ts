/** What the compiler refuses, and the types that follow from arguments. It is compiled with the tests, and never run. */
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
import { applyToPoints, compose, cropInput, exportGlb, resizeInput, toCocoRle, toFrame } from "sim3align/conventions";
import { Sim3AlignElement } from "sim3align/element";
import { applyPinhole, applyToObject3D, meshInputFromThree } from "sim3align/three";
import { type BufferGeometry, type Group, InstancedMesh, Mesh, PerspectiveCamera, type SkinnedMesh } from "three";

declare const aligner: Aligner;
declare const alignment: Alignment;
declare const floats: Float32Array;
declare const bytes: Uint8Array;
const camera = { fx: 1, fy: 1, cx: 0, cy: 0 };
const mesh = { positions: floats };
const size = { width: 2, height: 2 };
const object = { mask: bytes, mesh };
const input = {} as AlignInput;

/** The type of a result follows from the preset and the metrics. */
export async function results(options: AlignOptions | PaperOptions): Promise<void> {
  const precise: Alignment = await aligner.align(input, { preset: "precise", seed: undefined });
  const ofPaper: PaperOptions = { preset: "paper" };
  const paper: PaperAlignment = await aligner.align(input, ofPaper);
  const without: AlignOptions<false> = { metrics: false };
  const none: undefined = (await aligner.align(input, without)).metrics;
  const open: AlignOptions<boolean> = { metrics: Math.random() < 0.5 };
  const perhaps: Metrics | undefined = (await aligner.align(input, open)).metrics;
  const any: AlignResult = await aligner.align(input, options);
  for await (const { alignment } of aligner.alignAll([input], { preset: "paper", icp: "none" })) {
    void alignment?.metrics.iou;
    // @ts-expect-error the paper's method has no confidence
    void alignment?.confidence;
  }
  void [precise, paper, none, perhaps, any];
}

/** So does that of arrays; classes of three.js and of the DOM fit by their shape. */
export function conversions(group: Group, skinned: SkinnedMesh, geometry: BufferGeometry): void {
  const [single, double]: [Float32Array, Float64Array] = [
    applyToPoints(alignment, floats),
    applyToPoints(alignment, new Float64Array(3)),
  ];
  const text: string = toCocoRle({ data: bytes, ...size }).counts;
  const runs: readonly number[] = toCocoRle({ data: bytes, ...size }, { compressed: false }).counts;
  const depth: Uint16Array = resizeInput({ depth: { data: new Uint16Array(4), ...size } }, size).depth.data;
  const cropped: AlignInput = cropInput(
    { depth: { data: floats, ...size }, mask: { data: bytes, ...size }, camera: { K: [[1]] }, mesh: bytes },
    { left: 0, top: 0, width: 1, height: 1 },
  );
  const file: Uint8Array = exportGlb(bytes, alignment, { metrics: alignment.metrics });
  for (const source of [group, skinned, geometry, new Mesh(), new InstancedMesh(geometry, undefined, 3)]) {
    const input: AlignInput["mesh"] = meshInputFromThree(source);
    void input;
  }
  applyToObject3D(group, alignment, { camera: new PerspectiveCamera() });
  applyPinhole(new PerspectiveCamera(), camera, { ...size, far: 10 });
  const made: Sim3AlignElement = document.createElement("sim3-align");
  made.addEventListener("align", ({ detail }) => detail.objects.map(({ confidence }): number | null => confidence));
  void [single, double, text, runs, depth, cropped, file, made instanceof Sim3AlignElement];
}

/** Inputs with a part too few, too many, or of another kind. */
export async function refusedInputs(tracker: Tracker): Promise<void> {
  await aligner.align({ ...object, depth: bytes, camera: { width: 2, height: 2 }, depthKind: "affine-invariant" });
  // @ts-expect-error a bare array needs its size
  await aligner.align({ ...object, depth: floats, width: 2, camera });
  // @ts-expect-error a point map as a bare array, too
  await aligner.align({ ...object, pointMap: floats, width: 2 });
  // @ts-expect-error a point map has the depth in it
  await aligner.align({ ...object, pointMap: floats, depth: floats, ...size });
  // @ts-expect-error plain arrays are refused
  await aligner.align({ ...object, depth: [1, 2], width: 2, height: 1, camera });
  // @ts-expect-error misspelt
  await aligner.align({ ...object, depht: floats, ...size, camera });
  // @ts-expect-error cy is missing
  await aligner.align({ ...object, depth: bytes, camera: { fx: 1, fy: 1, cx: 0 } });
  // @ts-expect-error one form of intrinsics at a time
  await aligner.align({ ...object, depth: bytes, camera: { ...camera, fovYDeg: 50 } });
  // @ts-expect-error the content of a camera file is a cameraFile
  await aligner.align({ ...object, depth: bytes, camera: { cam_K: [] } });
  // @ts-expect-error one of the two
  await aligner.align({ ...object, depth: bytes, camera, cameraFile: "{}" });
  // @ts-expect-error an image id belongs to a camera file
  await aligner.align({ ...object, depth: bytes, camera, imageId: 3 });
  // @ts-expect-error the points of an affine-invariant map have no shape
  await aligner.align({ ...object, pointMap: { data: floats, ...size }, depthKind: "affine-invariant" });
  // @ts-expect-error a tracker has its mesh
  await tracker.next({ depth: bytes, mask: bytes, camera, mesh });
  // @ts-expect-error depth is no bytes
  resizeInput({ depth: { data: bytes, ...size } }, size);
}

/** Options and other arguments. */
export async function refusedOptions(error: unknown): Promise<void> {
  // @ts-expect-error these are options of results with metrics
  await aligner.align(input, { metrics: false } satisfies AlignOptions);
  // @ts-expect-error all objects need the depth map
  await aligner.alignScene({} as SceneInput, { transfer: true });
  // @ts-expect-error a worker has events
  await createAligner({ createWorker: () => ({ postMessage() {}, terminate() {} }) });
  // @ts-expect-error an option of preset "paper"
  await aligner.align(input, { guard: [0.5, 1.5] });
  // @ts-expect-error an option of preset "precise"
  await aligner.align(input, { preset: "paper", quality: "best" });
  // @ts-expect-error no such word
  await aligner.align(input, { scale: "fixed" });
  // @ts-expect-error a direction has three numbers
  await aligner.align(input, { cameraUp: [0, 1] });
  // @ts-expect-error no transform
  await aligner.align(input, { initial: { scale: 1 } });
  // @ts-expect-error an object, not a tuple
  await aligner.align(input, { symmetry: [[0, 1, 0]] });
  // @ts-expect-error correspondences are a Uint32Array
  await aligner.estimateSim3(floats, floats, [0, 0]);
  // @ts-expect-error at least one
  compose();
  // @ts-expect-error no such frame
  toFrame(alignment, "blender");
  // @ts-expect-error no such option
  document.createElement("sim3-align").options = { speed: "fast" };
  if (error instanceof Sim3AlignError) {
    const code: ErrorCode = error.code;
    // @ts-expect-error no such code
    if (code === "OOPS") return;
  }
}
