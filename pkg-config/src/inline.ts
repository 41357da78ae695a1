/// <reference path="./inlined.d.ts" />
/**
 * The package in one piece: the same as `sim3align`, with the WebAssembly and the worker's script inside the JavaScript,
 * for sandboxes, bundled servers, and bundlers that copy no other files. The file readers are in a second script, which is
 * imported when the first file is passed. A content security policy has to allow `worker-src blob:` for workers.
 * @packageDocumentation
 */
import core from "inlined:core";
import workerScript from "inlined:worker";
import { Aligner, type AlignerOptions } from "./aligner.js";

export * from "./index.js";

/** The same as `createAligner` of `sim3align`, but fetches nothing. */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options, {
    wasm: () => bytesOf(core),
    formatsWasm: async () => bytesOf((await import("inlined:formats")).default),
    workerScript,
  });
}

const bytesOf = (base64: string) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
