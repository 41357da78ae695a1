/** The readers of files. Small files are read at once; large ones in a worker, so that no frame has to wait for them. */
import { Sim3AlignError } from "sim3align";
import * as formats from "sim3align/formats";
import { gltfText } from "sim3align/input/webp";
import { startedFromAnywhere } from "sim3align/pool/port";
import type { ReaderAnswer, ReaderCall, Readers } from "./reader-worker.js";

/** A mask, 1 is the object, at its own size. */
export interface ReadMask {
  data: Uint8Array;
  width: number;
  height: number;
  /** Which values of its file are the object, for people. */
  reading?: string;
}

/** Larger files are read in the worker. Starting it takes longer than reading smaller ones. */
const LARGE_BYTES = 1 << 20;

interface Pending {
  resolve(value: unknown): void;
  reject(cause: Error): void;
}

let worker: Worker | null = null;
let lastId = 0;
const pending = new Map<number, Pending>();

function started(): Worker {
  if (worker !== null) return worker;
  const own = startedFromAnywhere(
    () => new Worker(new URL("./reader-worker.ts", import.meta.url), { type: "module", name: "reader" }),
    () => new URL("./reader-worker.ts", String(import.meta.url)),
    "reader",
  );
  own.addEventListener("message", ({ data }: MessageEvent<ReaderAnswer>) => {
    const call = pending.get(data.id);
    pending.delete(data.id);
    if ("error" in data) {
      const { error } = data;
      call?.reject(typeof error === "string" ? new Error(error) : new Sim3AlignError(error));
    } else call?.resolve(data.value);
    stopIfIdle();
  });
  own.addEventListener("error", ({ message }) => {
    for (const { reject } of pending.values()) reject(new Error(`The file could not be read: ${message}`));
    pending.clear();
    stopIfIdle();
  });
  worker = own;
  return own;
}

/** The memory of WebAssembly only grows, so the worker ends with its last file. */
function stopIfIdle(): void {
  if (pending.size > 0) return;
  worker?.terminate();
  worker = null;
}

function inWorker(name: keyof Readers, parameters: readonly unknown[]): Promise<unknown> {
  return new Promise((resolve, reject) => {
    const call: ReaderCall = { id: ++lastId, name, parameters };
    pending.set(call.id, { resolve, reject });
    started().postMessage(call);
  });
}

/** The size of a file in memory, and of those that it refers to; 0 for what is no file. */
function sizeOf(parameters: readonly unknown[]): number {
  return parameters.reduce<number>((sum, one) => {
    if (one instanceof Uint8Array || one instanceof ArrayBuffer) return sum + one.byteLength;
    if (one instanceof Blob) return sum + one.size;
    return sum + (typeof one === "object" && one !== null ? sizeOf(Object.values(one)) : 0);
  }, 0);
}

/** A reader that decides by the size of the file. */
const reader = <K extends keyof Readers>(name: K, atOnce: Readers[K]): Readers[K] =>
  ((...parameters: readonly unknown[]) =>
    sizeOf(parameters) > LARGE_BYTES
      ? inWorker(name, parameters)
      : (atOnce as (...parameters: readonly unknown[]) => unknown)(...parameters)) as Readers[K];

export const readDepth = reader("readDepth", formats.readDepth);
export const readMask = reader("readMask", formats.readMask);
export const readMesh = reader("readMesh", formats.readMesh);

/** A mesh file if it is a binary glTF that the 3D view can load as it is: it holds its buffers and images, and is not compressed by Draco. */
export function shownGlb(bytes: Uint8Array): Uint8Array | null {
  const json = gltfText(bytes);
  const isBinary = json !== "" && bytes[0] === 0x67;
  return isBinary && !/_draco_|"uri"\s*:\s*"(?!data:)/.test(json) ? bytes : null;
}
