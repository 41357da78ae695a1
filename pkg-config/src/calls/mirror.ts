/** A look at the mirror image of a mesh whose pose is in doubt: exporters that exchange two axes mirror it. */
import type { Alignment, Warning } from "../generated/types.js";
import type { CoreInput } from "../modules/core-input.js";
import type { CoreMesh } from "../values/prepared-mesh.js";
import type { JobContext } from "./context.js";
import { DOUBT } from "./notes.js";

/**
 * How much better the score of the mirror image is, where this explains the doubt. Of 48 real objects, most of which are nearly
 * their own mirror images, it is up to 0.05 better; of a mesh that was mirrored, 0.66.
 */
const BETTER = 0.2;

const mirrorImage: Warning = {
  code: "MESH_LOOKS_MIRRORED",
  message:
    "The mirror image of the mesh fits the image far better: the mesh seems to be mirrored, as by an exporter that exchanges two axes. Negate one coordinate of all its vertices and turn its triangles round, or export it again.",
};

/** The alignment, with a warning if it is in doubt and the mirror image of the mesh is not. */
export async function comparedWithMirror(
  found: Alignment,
  input: CoreInput,
  options: object,
  context: JobContext,
): Promise<Alignment> {
  if (found.confidence >= DOUBT) return found;
  const mirrored = { ...input, mesh: mirrorOf(input.mesh) };
  const other = await context
    .quiet()
    .search("align", mirrored, { ...options, initial: undefined, metrics: false })
    .catch(() => undefined);
  const isBetter =
    other !== undefined && other.confidence > DOUBT && other.diagnostics.score > found.diagnostics.score + BETTER;
  return isBetter ? { ...found, warnings: [...found.warnings, mirrorImage] } : found;
}

/** The mesh with −x, by its shape alone. */
function mirrorOf({ positions, indices }: CoreMesh): CoreMesh {
  const moved = positions.map((x, i) => (i % 3 === 0 ? -x : x));
  const corners = indices ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  // The other two corners of a triangle change places, so that it still faces outward.
  return {
    positions: moved,
    indices: corners.map((_, i) => corners[i + (i % 3 === 1 ? 1 : i % 3 === 2 ? -1 : 0)] ?? 0),
  };
}
