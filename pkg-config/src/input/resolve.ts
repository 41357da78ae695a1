/** Converts the inputs of calls to the typed arrays and numbers of the core. */

import type { Warning } from "../generated/types.js";
import type { CoreFrame, CoreInput, CoreView, CoreViews } from "../modules/core-input.js";
import type { FileReaders } from "../modules/readers.js";
import type { InputNotes } from "../types/results.js";
import { invalidArgument, renamed, Sim3AlignError } from "../values/error.js";
import { isRecord } from "../values/kinds.js";
import { checkNames, part, withoutUndefined } from "../values/validation.js";
import { readMask, shapedMask } from "./mask.js";
import { type MeshAndWarnings, readCoreMesh } from "./mesh.js";
import { coreSim3 } from "./sim3.js";
import { type Resolved, readView, viewProperties } from "./view.js";

const frameProperties = [...viewProperties, "mask", "resizeMask", "maskIndex"];
/** The properties of an input of `align`. */
export const inputProperties: readonly string[] = [...frameProperties, "mesh"];

const spelling = "Check the spelling. Options belong in the second argument.";
const oneMesh =
  "This is an input of align(). Omit its mesh: frames have that of their tracker, views the one beside them.";

/**
 * Resolves the input of `align` and `evaluate`. Readers are loaded only if a file needs them.
 * @param meshId the id of a prepared mesh
 * @throws {@link Sim3AlignError} for arguments of the wrong type, and the errors of the file readers
 */
export async function resolveInput(
  input: unknown,
  readers: FileReaders,
  meshId?: number,
): Promise<Resolved<CoreInput>> {
  checkInput(input);
  const frame = await frameOf(input, readers, true);
  const read = await readCoreMesh(input.mesh, readers, frame.core.image !== undefined, meshId);
  return { core: { ...frame.core, mesh: read.mesh } as CoreInput, notes: withMesh(frame, read) };
}

/** Resolves the view of an input, whose mask and mesh are not read. */
export async function resolveView(input: unknown, readers: FileReaders): Promise<Resolved<CoreView>> {
  checkInput(input);
  return readView(input, readers);
}

/** Resolves a frame, whose mask may be missing. */
export async function resolveFrame(
  frame: unknown,
  readers: FileReaders,
  more: readonly string[] = [],
): Promise<Resolved<CoreFrame>> {
  const given = part("frame", frame, "{ depth, camera, mask? }");
  checkNames("", given, [...frameProperties, ...more], given.mesh === undefined ? spelling : oneMesh);
  return frameOf(given, readers, given.mask !== undefined && given.mask !== null);
}

/** Resolved views, and what the files of each say. */
export interface ResolvedViews {
  core: CoreViews;
  notes: readonly InputNotes[];
}

/**
 * Resolves the input of `alignViews`.
 * @param meshId the id of a prepared mesh
 * @throws {@link Sim3AlignError} whose argument names the view
 */
export async function resolveViews(input: unknown, readers: FileReaders, meshId?: number): Promise<ResolvedViews> {
  const { mesh, views, ...more } = isRecord(input) ? input : {};
  if (!Array.isArray(views)) {
    throw invalidArgument("views", views, "an array of views", "Pass { mesh, views: [{ depth, mask, camera }] }.");
  }
  checkNames("input.", more, ["mesh", "views"], "What belongs to a view is a property of the view.");
  const frames: Resolved<CoreFrame>[] = [];
  for (const [k, view] of views.entries()) frames.push(await viewOf(view, k, readers));
  const isColored = frames.some(({ core }) => core.image !== undefined);
  const read = await readCoreMesh(mesh, readers, isColored, meshId);
  const core = { mesh: read.mesh, views: frames.map((frame) => frame.core) };
  return { core, notes: frames.map((frame) => withMesh(frame, read)) };
}

async function viewOf(view: unknown, index: number, readers: FileReaders): Promise<Resolved<CoreFrame>> {
  try {
    const { core, notes } = await resolveFrame(view, readers, ["cameraToWorld"]);
    const pose = isRecord(view) ? view.cameraToWorld : undefined;
    return { core: pose === undefined || pose === null ? core : { ...core, cameraToWorld: coreSim3(pose) }, notes };
  } catch (error) {
    if (!(error instanceof Sim3AlignError)) throw error;
    throw renamed(error, `views[${index}]${error.argument === "frame" ? "" : `.${error.argument}`}`);
  }
}

async function frameOf(
  input: Record<string, unknown>,
  readers: FileReaders,
  isMasked: boolean,
): Promise<Resolved<CoreFrame>> {
  const { core: view, notes } = await readView(input, readers);
  const { resizeMask, maskIndex } = input;
  const frame = { ...view, resizeMask };
  if (!isMasked) return { core: withoutUndefined(frame) as CoreFrame, notes };
  const size = { width: Number(view.width), height: Number(view.height) };
  const mask = shapedMask("mask", await readMask(input.mask, size, readers.formats, maskIndex), size, resizeMask);
  const masked = { ...frame, mask: mask.data, maskWidth: mask.width, maskHeight: mask.height };
  const maskNotes = withoutUndefined({ maskReading: mask.reading });
  const unread = [...notes.unread, ...(mask.unread ?? [])];
  return { core: withoutUndefined(masked) as CoreFrame, notes: { ...notes, ...maskNotes, unread } };
}

const holdsCopies = (copies: number): Warning => ({
  code: "MESH_HOLDS_COPIES",
  message: `The mesh file places ${copies} copies of one mesh, and all of them are read as one object. If the mask shows one of them, pass a file that holds one.`,
});

/** Notes with those on the mesh; its colours matter only where there is a photo to compare them with. */
export const withMesh = (
  { core, notes }: { core: Pick<CoreFrame, "image">; notes: InputNotes },
  { mesh, warnings, unread = [] }: MeshAndWarnings,
): InputNotes => ({
  ...notes,
  unread: [...notes.unread, ...unread],
  warnings: [...notes.warnings, ...(mesh.copies === undefined ? [] : [holdsCopies(mesh.copies)])],
  ...(core.image === undefined ? {} : { colors: warnings }),
  ...withoutUndefined({ origin: mesh.fileOrigin }),
});

/** Rejects misspelt properties, which would otherwise be ignored. */
function checkInput(input: unknown): asserts input is Record<string, unknown> {
  checkNames("input.", part("input", input, "{ depth, mask, mesh, camera }"), inputProperties, spelling);
}
