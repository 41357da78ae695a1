/** Objects as the files of a result hold them: in the proportions that were found, and upright if that is asked for. */
import { stretchGlb, stretchMesh } from "../conventions/stretch.js";
import { type UprightOptions, uprightGlb, uprightMesh } from "../conventions/upright.js";
import type { Stretch } from "../index.js";
import { readMesh } from "../input/mesh.js";
import type { Sim3Like } from "../input/sim3.js";
import type { MeshArrays, MeshInput } from "../input/types.js";
import { fileReaders } from "../modules/readers.js";
import { isRecord, withoutUndefined } from "../values/values.js";

/** A mesh for a file, with its transform. */
export interface ExportedMesh<M> {
  mesh: M;
  transform: Sim3Like;
}

/** How an object is exported. */
export interface ExportedAs {
  /** The `proportions` of its result, if these were asked for. */
  proportions: Pick<Stretch, "matrix" | "stretch"> | undefined;
  /** In an upright frame, if that is asked for. */
  upright: UprightOptions | undefined;
}

/** Arrays, for an export. `pose` is the result, whose facts are kept. */
export function exportedArrays<M extends MeshArrays>(
  mesh: M,
  pose: Sim3Like,
  { proportions, upright }: ExportedAs,
): ExportedMesh<M> {
  const stretched = inProportion(mesh, pose, proportions);
  if (upright === undefined) return { ...stretched, transform: withFacts(stretched.transform, pose) };
  const straight = uprightMesh(stretched.mesh, stretched.transform, upright);
  return { mesh: straight.mesh, transform: withFacts(straight.transform, pose) };
}

/** The file of a GLB, whose materials are kept, or the arrays of another mesh, for an export. */
export async function exportedMesh(
  given: MeshInput,
  pose: Sim3Like,
  as: ExportedAs,
): Promise<ExportedMesh<Uint8Array | MeshArrays>> {
  const { bytes, format } = (isRecord(given) ? given : {}) as { bytes?: Uint8Array; format?: string };
  const read = async () => (await readMesh(given, fileReaders, false)).mesh as MeshArrays;
  if (format !== "glb" || bytes === undefined) return exportedArrays(await read(), pose, as);
  const { proportions, upright } = as;
  const glb = proportions === undefined ? bytes : stretchGlb(bytes, proportions);
  if (upright === undefined) return { mesh: glb, transform: withFacts(proportions ?? pose, pose) };
  const stretched = inProportion(await read(), pose, proportions);
  const straight = uprightGlb(glb, stretched.mesh, stretched.transform, upright);
  return { mesh: straight.mesh, transform: withFacts(straight.transform, pose) };
}

const inProportion = <M extends MeshArrays>(mesh: M, pose: Sim3Like, proportions: ExportedAs["proportions"]) =>
  proportions === undefined
    ? { mesh, transform: pose }
    : { mesh: stretchMesh(mesh, proportions), transform: proportions as Sim3Like };

/** Another transform of an object, with the metrics and the confidence of its result. */
function withFacts(transform: Sim3Like, result: Sim3Like): Sim3Like {
  if (transform === result || !isRecord(result) || !isRecord(transform)) return transform;
  const { metrics, confidence } = result as Record<string, unknown>;
  return { ...transform, ...withoutUndefined({ metrics, confidence }) } as Sim3Like;
}
