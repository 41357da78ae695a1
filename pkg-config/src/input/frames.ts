/** Converts views and frames to the typed arrays and numbers of the core. */
import { invalidArgument, Sim3AlignError } from "../error.js";
import type { LoadFormats } from "../formats-module.js";
import { coreSim3, type Sim3Like } from "../sim3.js";
import { isRecord, withoutUndefined } from "../values.js";
import type { CoreFrame, CoreInput, CoreViews } from "./core-input.js";
import { checkSides } from "./depth.js";
import { readMask } from "./mask.js";
import { readMesh } from "./mesh.js";
import { imageAndCamera, imageProperties } from "./resolve.js";

/** A resolved frame, and the warnings of its files. */
export interface ResolvedFrame {
  core: CoreFrame;
  warnings: readonly string[];
}

const frameProperties: readonly string[] = [...imageProperties, "mask", "resizeMask"];

/** Resolves a frame, whose mask may be missing. */
export async function resolveFrame(
  frame: unknown,
  formats: LoadFormats,
  more: readonly string[] = [],
): Promise<ResolvedFrame> {
  const properties = [...frameProperties, ...more];
  if (!isRecord(frame)) {
    throw invalidArgument("frame", frame, "{ depth, camera, mask? }", "See FrameInput in the documentation.");
  }
  const unknown = Object.keys(frame).find((name) => !properties.includes(name));
  if (unknown !== undefined) {
    throw new Sim3AlignError({
      code: "INVALID_ARGUMENT",
      argument: unknown,
      found: "an unknown property",
      expected: properties.join(", "),
      remedy: "Check the spelling. Options belong in the second argument.",
    });
  }
  checkSides("", frame);
  const { warnings, ...image } = await imageAndCamera(frame, formats);
  const core = { ...image, resizeMask: frame.resizeMask };
  if (frame.mask === undefined || frame.mask === null) return { core: withoutUndefined(core) as CoreFrame, warnings };
  const mask = await readMask(frame.mask, Number(image.width) * Number(image.height), formats);
  const masked = { ...core, mask: mask.data, maskWidth: mask.width, maskHeight: mask.height };
  return { core: withoutUndefined(masked) as CoreFrame, warnings };
}

/** Resolved views, and the warnings of the files of each. */
export interface ResolvedViews {
  core: CoreViews;
  warnings: readonly (readonly string[])[];
}

/**
 * Resolves the input of `alignViews`.
 * @param meshId the id of a prepared mesh
 * @throws {@link Sim3AlignError} whose argument names the view
 */
export async function resolveViews(input: unknown, formats: LoadFormats, meshId?: number): Promise<ResolvedViews> {
  const { mesh, views, ...rest } = isRecord(input) ? input : { mesh: undefined, views: undefined };
  if (!Array.isArray(views)) {
    throw invalidArgument("views", views, "an array of views", "Pass { mesh, views: [{ depth, mask, camera }] }.");
  }
  const unknown = Object.keys(rest)[0];
  if (unknown !== undefined) {
    throw new Sim3AlignError({
      code: "INVALID_ARGUMENT",
      argument: `input.${unknown}`,
      found: "an unknown property",
      expected: "mesh, views",
      remedy: "What belongs to a view is a property of the view.",
    });
  }
  const resolved = [];
  for (const [k, view] of views.entries()) resolved.push(await resolveView(view, k, formats));
  const core = {
    // A prepared mesh is kept for calls with a photo.
    mesh: withoutUndefined({
      ...(await readMesh(mesh, formats, meshId !== undefined)).mesh,
      id: meshId,
    }) as CoreInput["mesh"],
    views: resolved.map((view) => view.core),
  };
  return { core, warnings: resolved.map((view) => view.warnings) };
}

async function resolveView(view: unknown, index: number, formats: LoadFormats): Promise<ResolvedFrame> {
  try {
    const { core, warnings } = await resolveFrame(view, formats, ["cameraToWorld"]);
    const { cameraToWorld } = view as { cameraToWorld?: Sim3Like | null };
    if (cameraToWorld === undefined || cameraToWorld === null) return { core, warnings };
    return { core: { ...core, cameraToWorld: coreSim3(cameraToWorld) }, warnings };
  } catch (error) {
    if (!(error instanceof Sim3AlignError)) throw error;
    const { code, argument, found, expected, remedy } = error;
    const named = `views[${index}]${argument === "frame" ? "" : `.${argument}`}`;
    throw new Sim3AlignError({ code, argument: named, found, expected, remedy }, { cause: error });
  }
}
