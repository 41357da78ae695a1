/// <reference path="./inlined.d.ts" />
/**
 * The package in one piece: the same as `sim3align`, with the WebAssembly and the worker's script inside the JavaScript,
 * for sandboxes, and for bundlers that copy no other files. The file readers are in a script that is imported once a file
 * is passed. Workers need `worker-src blob:` where a content security policy names any.
 * @packageDocumentation
 */
import core from "inlined:core";
import workerScript from "inlined:worker";
import { Aligner, type AlignerOptions } from "./aligner.js";

export * from "./index.js";

/** As `createAligner` of `sim3align`; nothing is fetched. */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options, {
    wasm: () => bytesOf(core),
    formatsWasm: async () => bytesOf((await import("inlined:formats")).default),
    workerScript,
  });
}

const bytesOf = (base64: string) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
