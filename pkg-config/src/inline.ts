/// <reference path="./inlined.d.ts" />
/**
 * The package as a single script: the same as `sim3align`, with the core module and the worker script embedded, for
 * sandboxes, bundled servers, and bundlers that copy no assets. The module that reads files is a script of its own, which
 * is imported when it is first needed. `createAligner({ wasm })` adds the other modules, such as that of `alignScene`,
 * `alignViews` and `track`, or that of `register`, `estimateSim3` and `preset: "paper"`. For workers, a content security
 * policy must allow `worker-src blob:`.
 * @packageDocumentation
 */
import core from "inlined:core";
import workerScript from "inlined:worker";
import { Aligner } from "./aligner/aligner.js";
import type { AlignerOptions } from "./aligner/aligner-options.js";
import { moduleFile } from "./modules/module.js";
import { failure } from "./values/error.js";

export * from "./index.js";

/** Like `createAligner` of `sim3align`, but without fetching files. */
export async function createAligner(options: AlignerOptions = {}): Promise<Aligner> {
  return Aligner.create(options, {
    wasm: {
      core: () => unpacked(core),
      formats: async () => unpacked((await import("inlined:formats")).default),
      depthFiles: () => notEmbedded("depthFiles"),
      splats: () => notEmbedded("splats"),
      webp: () => notEmbedded("webp"),
      joint: () => notEmbedded("joint"),
      registration: () => notEmbedded("registration"),
    },
    workerScript,
  });
}

/** The bytes of a module that was gzipped and encoded as base64. */
function unpacked(base64: string): Promise<ArrayBuffer> {
  const gzipped = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  return new Response(new Blob([gzipped]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

function notEmbedded(name: string): never {
  const file = `sim3align/wasm/${moduleFile(name)}`;
  const remedy = `Import ${file} as bytes or as a data URL, as your bundler does it, and pass createAligner({ wasm: { ${name} } }); or import from "sim3align".`;
  throw failure("NOT_INITIALISED", `wasm.${name}`, "a module that sim3align/inline does not embed", file, remedy);
}
