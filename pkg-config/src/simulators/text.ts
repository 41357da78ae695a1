/** Numbers and meshes as text. */
import type { SimulatorBody } from "./scene.js";

/** A number with seven digits. */
const short = (x: number) => String(Number(x.toPrecision(7)));

/** Numbers with spaces between them. */
export const spaced = (numbers: ArrayLike<number>): string => Array.from(numbers, short).join(" ");

/** The meshes of bodies as files by their paths, in `meshes/`: the surface `NAME.obj`, and each convex part `NAME_K.obj`. */
export function meshFiles(bodies: readonly SimulatorBody[]): Record<string, string> {
  const files: Record<string, string> = {};
  for (const { name, mesh, parts } of bodies) {
    files[`meshes/${name}.obj`] = objOf(mesh);
    for (const [k, part] of parts.entries()) files[`meshes/${name}_${k}.obj`] = objOf(part);
  }
  return files;
}

/** A mesh as Wavefront OBJ. */
function objOf({ positions, indices }: { positions: ArrayLike<number>; indices: ArrayLike<number> }): string {
  const lines: string[] = [];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    lines.push(`v ${spaced([positions[i] as number, positions[i + 1] as number, positions[i + 2] as number])}`);
  }
  for (let i = 0; i + 2 < indices.length; i += 3) {
    lines.push(`f ${[0, 1, 2].map((k) => (indices[i + k] as number) + 1).join(" ")}`);
  }
  return `${lines.join("\n")}\n`;
}
