/** Names of objects in the paths of their files. */

/** The name of a scene whose files tell none. */
export const OWN_FILES = "Own files";

/** Words that tell the kind of a file, not its object. */
const kindWords = new Set("mask masks visib visible mesh meshes model models obj object objects gt truth".split(" "));

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

/** The words and numbers that the names of the files of one object share, in any order, without the number of the image. */
export function keyOf(path: string, imageId: string | null): string {
  const words =
    titleOf(path)
      .toLowerCase()
      .match(/\p{L}+|\p{N}+/gu) ?? [];
  return words
    .map((word) => word.replace(/^0+(?=\d)/, ""))
    .filter((word) => imageId === null || word !== `${Number(imageId)}`)
    .sort()
    .join(" ");
}
