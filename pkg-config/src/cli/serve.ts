/** `sim3align serve`: aligns what lines of JSON on standard input name, and writes a line for each; the process stays warm. */
import { availableParallelism } from "node:os";
import { createInterface } from "node:readline";
import { autoWorkers } from "../aligner/aligner-options.js";
import { type ReadCaseOptions, readCaseFolder, readMeshFile } from "../case-folder.js";
import { frameNames, openFrames } from "../frames-folder.js";
import { type Aligner, type AlignInput, createAligner } from "../index.js";
import { inputProperties } from "../input/resolve.js";
import { read } from "../read-files.js";
import { failure, invalidArgument } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { checkNames, withoutUndefined } from "../values/validation.js";
import { onlyView } from "./align.js";
import { failureEntry } from "./entry.js";
import type { Flags } from "./flags.js";
import { caseKind, sceneKind, videoKind } from "./folders.js";

/** Types of the numbers of inline arrays. */
const arrays = {
  float32: Float32Array,
  float64: Float64Array,
  uint16: Uint16Array,
  uint8: Uint8Array,
  bool: Uint8Array,
  uint32: Uint32Array,
} as const;

/** The fields of a request without a case: files, arrays and their size. */
const parts = ["depth", "pointMap", "mask", "mesh", "camera", "cameraFile", "image", "width", "height"];

/** Requests that are read while others are worked on. */
const READ_AHEAD = 2;

/** Answers the requests on standard input until it ends. Returns whether all have a result. */
export async function serve({ workers = "auto" }: Flags): Promise<boolean> {
  const size = workers === "auto" ? autoWorkers(availableParallelism()) : workers;
  const aligner = await createAligner({ workers: size });
  const running = new Set<Promise<void>>();
  let isWhole = true;
  try {
    let number = 0;
    for await (const line of createInterface({ input: process.stdin, crlfDelay: Infinity })) {
      if (line.trim() === "") continue;
      const answering: Promise<void> = answer(aligner, line, number++).then((entry) => {
        running.delete(answering);
        isWhole &&= "result" in entry;
        process.stdout.write(`${JSON.stringify(entry)}\n`);
      });
      running.add(answering);
      if (running.size >= size + READ_AHEAD) await Promise.race(running);
    }
    await Promise.all(running);
  } finally {
    aligner.dispose();
  }
  return isWhole;
}

/** The answer to a request: its id, or its number from 0, with the result of `align` or the error. */
async function answer(aligner: Aligner, line: string, number: number): Promise<object> {
  let id: unknown = number;
  try {
    const request: unknown = JSON.parse(line);
    if (!isRecord(request)) throw invalidArgument("request", request, "an object in a line", "Write one line each.");
    id = request.id ?? number;
    const { id: _, options = {}, ...more } = request;
    checkNames("request.", more, ["case", ...inputProperties], "Options of align() belong in options.");
    return { id, result: await aligner.align(await inputOf(more), options as object) };
  } catch (error) {
    const isSyntax = error instanceof SyntaxError;
    const thrown = isSyntax ? invalidArgument("request", line.slice(0, 60), "JSON in one line", error.message) : error;
    return { id, ...failureOf(thrown) };
  }
}

/** The error, which of options is of this request only. */
function failureOf(error: unknown): object {
  try {
    return { error: failureEntry(error).error };
  } catch (usage) {
    return { error: { code: "INVALID_OPTION", message: (usage as Error).message } };
  }
}

/** The input of a request: a case folder, or files and arrays. */
async function inputOf(request: Record<string, unknown>): Promise<AlignInput> {
  const { case: folder, ...own } = request;
  if (folder != null) {
    const others = parts.filter((name) => name in own).join(", ");
    const remedy = "Pass a case, or its files one by one.";
    if (others !== "") throw refusedCase(`a case beside ${others}`, "one of them", remedy);
    if (typeof folder !== "string") throw invalidArgument("request.case", folder, "the path of a folder", remedy);
    return inputIn(folder, own);
  }
  // Both together are refused as the input of align() is.
  const isFile = typeof own.camera === "string" && own.cameraFile === undefined;
  const { camera, cameraFile = isFile ? camera : undefined, mesh, ...others } = own;
  const files = { ...others, cameraFile, camera: isFile ? undefined : camera };
  const names = Object.keys(files).filter((name) => parts.includes(name));
  const values = await Promise.all(names.map((name) => partOfRequest(name, files[name as keyof typeof files])));
  const filled = Object.fromEntries(names.map((name, k) => [name, values[k]]));
  return withoutUndefined({ ...files, ...filled, mesh: await meshOf(mesh) }) as unknown as AlignInput;
}

const refusedCase = (found: string, expected: string, remedy: string) =>
  failure("INVALID_ARGUMENT", "request.case", found, expected, remedy);

/** The input in a folder, which `align` would read alike. Scenes and frames have results of other calls. */
async function inputIn(folder: string, settings: ReadCaseOptions): Promise<AlignInput> {
  if (!caseKind.is(folder) && sceneKind.is(folder)) {
    const remedy = `Pass it to "sim3align ${sceneKind.command}", or its files one by one, with the mask and the mesh of an object.`;
    throw refusedCase(`a scene at ${folder}`, "a case of one object", remedy);
  }
  const { length } = await frameNames(folder);
  if (length === 0) return (await readCaseFolder(folder, settings)).input;
  const view = await onlyView(folder, await openFrames(folder, settings));
  if (view !== undefined) return view.input;
  const remedy = `Pass it to "sim3align ${caseKind.command}", or as a video to "sim3align ${videoKind.command}".`;
  throw refusedCase(`${length} frames at ${folder}`, "one frame with a mask", remedy);
}

/** A file by its path, an inline array `{ base64, dtype, shape }`, or the bytes of a file, `{ base64 }`. */
async function partOfRequest(argument: string, value: unknown): Promise<unknown> {
  if (typeof value === "string") return read(argument, value);
  if (!isRecord(value) || typeof value.base64 !== "string") return value;
  const { base64, dtype, shape } = value;
  const bytes = new Uint8Array(Buffer.from(base64, "base64"));
  if (dtype === undefined) return bytes;
  const Numbers = arrays[dtype as keyof typeof arrays];
  if (Numbers === undefined || bytes.length % Numbers.BYTES_PER_ELEMENT !== 0) {
    throw invalidArgument(`${argument}.dtype`, dtype, `one of ${Object.keys(arrays).join(", ")}`, "Convert the array.");
  }
  const data = new Numbers(bytes.buffer);
  const [height, width] = Array.isArray(shape) ? shape : [];
  return height === undefined || argument.startsWith("mesh") ? data : { data, width, height };
}

async function meshOf(mesh: unknown): Promise<unknown> {
  if (typeof mesh === "string") return readMeshFile(mesh);
  if (!isRecord(mesh) || !isRecord(mesh.positions)) return partOfRequest("mesh", mesh);
  const parts = Object.entries(mesh).map(async ([name, part]) => [name, await partOfRequest(`mesh.${name}`, part)]);
  return Object.fromEntries(await Promise.all(parts));
}
