/** Pairs masks with meshes by their names. */
import { folderOf } from "./files.js";

/** A pair of indices; `isSure` if the names, or the lack of any other choice, leave no doubt. */
export interface Match {
  mask: number;
  mesh: number | null;
  isSure: boolean;
}

/** Words that tell the kind of a file, not its object. */
const kindWords = new Set(
  "mask masks matte seg segmentation visib visible mesh meshes model models obj object objects textured simplified mesh3d glb".split(
    " ",
  ),
);

/** The words of a name that tell the object. "IMG_2-coffeeCup.mask" and "coffee cup" share two. */
export function wordsOf(path: string): string[] {
  const at = /[^\p{L}\p{N}]+|(?<=\p{L})(?=\p{N})|(?<=\p{N})(?=\p{L})/u;
  const parts = path.replace(/\.[^./]+$/, "").split("/");
  const words = (text: string) =>
    text
      .replace(/([a-z])([A-Z])/g, "$1 $2")
      .toLowerCase()
      .split(at)
      .filter((word) => word !== "" && !kindWords.has(word))
      .map((word) => (/^\d+$/.test(word) ? `${Number(word)}` : word));
  const own = words(parts.at(-1) ?? "");
  // "cup/mask.png" is named by its folder.
  return own.length > 0 ? own : words(parts.at(-2) ?? "");
}

/** The name of an object as its file has it, without the words at either end that tell the kind of the file. */
export function titleOf(path: string): string {
  const [own = "", folder = ""] = path.split("/").reverse();
  return trimmed(own.replace(/\.[^./]+$/, "")) || trimmed(folder);
}

function trimmed(name: string): string {
  const parts = name.split(/([^\p{L}\p{N}]+)/u);
  const isKind = (part: string | undefined) => part !== undefined && (part === "" || kindWords.has(part.toLowerCase()));
  while (parts.length > 0 && isKind(parts[0])) parts.splice(0, 2);
  while (parts.length > 0 && isKind(parts.at(-1))) parts.splice(-2);
  return parts.join("");
}

/** How well the names of a mask and a mesh agree, 0 to 1. */
function agreement(a: readonly string[], b: readonly string[]): number {
  const shared = a.filter((word) => b.includes(word)).length;
  if (shared === 0) return 0;
  // Names in which each has words of its own agree less than those of which one contains the other.
  return shared / Math.max(Math.min(a.length, b.length), 1) - 0.01 * (a.length + b.length - 2 * shared);
}

/**
 * Pairs each mask with at most one mesh, the best pairs first; the order of the files does not matter.
 *
 * @param masks names of masks: paths, or titles of labels
 * @param meshes paths
 */
export function paired(masks: readonly string[], meshes: readonly string[]): Match[] {
  if (masks.length === 1 && meshes.length === 1) return [{ mask: 0, mesh: 0, isSure: true }];
  const alone = (paths: readonly string[], path: string) =>
    folderOf(path) !== "" && paths.filter((other) => folderOf(other) === folderOf(path)).length === 1;
  const scored = masks.flatMap((maskPath, mask) =>
    meshes.map((meshPath, mesh) => {
      const together = folderOf(maskPath) === folderOf(meshPath) && alone(masks, maskPath) && alone(meshes, meshPath);
      return { mask, mesh, score: (together ? 2 : 0) + agreement(wordsOf(maskPath), wordsOf(meshPath)) };
    }),
  );
  scored.sort((a, b) => b.score - a.score || a.mask - b.mask || a.mesh - b.mesh);
  const matches: Match[] = masks.map((_, mask) => ({ mask, mesh: null, isSure: false }));
  const taken = new Set<number>();
  for (const { mask, mesh, score } of scored) {
    const match = matches[mask];
    if (match === undefined || match.mesh !== null || taken.has(mesh)) continue;
    const rivals = scored.filter((other) => other.score === score && (other.mask === mask || other.mesh === mesh));
    if (score > 0) Object.assign(match, { mesh, isSure: rivals.length === 1 });
    if (score > 0) taken.add(mesh);
  }
  // What is left over, in order: a guess, unless only one way is left.
  const [openMasks, openMeshes] = [
    matches.filter(({ mesh }) => mesh === null),
    meshes.map((_, mesh) => mesh).filter((mesh) => !taken.has(mesh)),
  ];
  const isOnly = openMasks.length === 1 && openMeshes.length === 1;
  openMasks.forEach((match, i) => {
    match.mesh = openMeshes[i] ?? null;
    match.isSure = isOnly && match.mesh !== null;
  });
  return matches;
}
