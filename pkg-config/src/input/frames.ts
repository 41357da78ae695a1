/** Converts views and frames to the typed arrays and numbers of the core. */

import type { FileReaders } from "../modules/readers.js";
import type { InputNotes } from "../types/results.js";
import { invalidArgument, renamed, Sim3AlignError } from "../values/error.js";
import { checkNames, isRecord, withoutUndefined } from "../values/values.js";
import type { CoreFrame, CoreViews } from "./core-input.js";
import { checkSides } from "./depth.js";
import { readMask } from "./mask.js";
import { readCoreMesh } from "./mesh.js";
import { frameProperties, readFrame, spelling } from "./resolve.js";
import { coreSim3, type Sim3Like } from "./sim3.js";

/** A resolved frame, and what its files say. */
export interface ResolvedFrame {
  core: CoreFrame;
  notes: InputNotes;
}

/** Resolves a frame, whose mask may be missing. */
export async function resolveFrame(
  frame: unknown,
  readers: FileReaders,
  more: readonly string[] = [],
): Promise<ResolvedFrame> {
  const properties = [...frameProperties, ...more];
  if (!isRecord(frame)) {
    throw invalidArgument("frame", frame, "{ depth, camera, mask? }", "See FrameInput in the documentation.");
  }
  checkNames("", frame, properties, spelling);
  checkSides("", frame);
  const { view, notes } = await readFrame(frame, readers);
  const core = { ...view, resizeMask: frame.resizeMask };
  if (frame.mask === undefined || frame.mask === null) return { core: withoutUndefined(core) as CoreFrame, notes };
  const mask = await readMask(frame.mask, Number(view.width) * Number(view.height), readers.formats);
  const masked = { ...core, mask: mask.data, maskWidth: mask.width, maskHeight: mask.height };
  return { core: withoutUndefined(masked) as CoreFrame, notes };
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
  const given = isRecord(input) ? input : {};
  const { mesh, views } = given;
  if (!Array.isArray(views)) {
    throw invalidArgument("views", views, "an array of views", "Pass { mesh, views: [{ depth, mask, camera }] }.");
  }
  checkNames("input.", given, ["mesh", "views"], "What belongs to a view is a property of the view.");
  const resolved = [];
  for (const [k, view] of views.entries()) resolved.push(await resolveView(view, k, readers));
  const isColored = resolved.some(({ core }) => core.image !== undefined);
  const read = await readCoreMesh(mesh, readers, isColored, meshId);
  const core = { mesh: read.mesh, views: resolved.map((view) => view.core) };
  // Colours matter only where there is a photo to compare them with.
  const notesOf = ({ core, notes }: ResolvedFrame) =>
    core.image === undefined ? notes : { ...notes, colors: read.warnings };
  return { core, notes: resolved.map(notesOf) };
}

async function resolveView(view: unknown, index: number, readers: FileReaders): Promise<ResolvedFrame> {
  try {
    const { core, notes } = await resolveFrame(view, readers, ["cameraToWorld"]);
    const { cameraToWorld } = view as { cameraToWorld?: Sim3Like | null };
    if (cameraToWorld === undefined || cameraToWorld === null) return { core, notes };
    return { core: { ...core, cameraToWorld: coreSim3(cameraToWorld) }, notes };
  } catch (error) {
    if (!(error instanceof Sim3AlignError)) throw error;
    throw renamed(error, `views[${index}]${error.argument === "frame" ? "" : `.${error.argument}`}`);
  }
}
