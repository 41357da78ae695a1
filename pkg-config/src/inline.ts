/// <reference path="./inlined.d.ts" />
/**
 * The package as a single script: the same as `sim3align`, with the WebAssembly module and the worker script embedded,
 * for sandboxes, bundled servers, and bundlers that copy no assets. The file readers, the module of `alignScene`,
 * `alignViews` and `track`, and that of `register`, `estimateSim3` and `preset: "paper"` are in scripts of their own, which
 * are imported when they are first needed. For workers, a content security policy must allow `worker-src blob:`.
 * @packageDocumentation
 */
import core from "inlined:core";
import workerScript from "inlined:worker";
import { Aligner } from "./aligner/aligner.js";
import type { AlignerOptions } from "./aligner/aligner-options.js";

export * from "./index.js";

/** Like `createAligner` of `sim3align`, but without fetching files. */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options, {
    wasm: {
      core: () => bytesOf(core),
      formats: async () => bytesOf((await import("inlined:formats")).default),
      depthFiles: async () => bytesOf((await import("inlined:depth-files")).default),
      splats: async () => bytesOf((await import("inlined:splats")).default),
      webp: async () => bytesOf((await import("inlined:webp")).default),
      joint: async () => bytesOf((await import("inlined:joint")).default),
      registration: async () => bytesOf((await import("inlined:registration")).default),
    },
    workerScript,
  });
}

const bytesOf = (base64: string) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
