/** Files that the user or a sample provides, from disk and folders. */
import type { NamedFile } from "../state/inputs.js";

/** The part of a path after its last slash. */
export const baseName = (path: string): string => path.slice(path.lastIndexOf("/") + 1);

/** The part of a path up to its last slash, which it includes; empty without a folder. */
export const folderOf = (path: string): string => path.slice(0, path.lastIndexOf("/") + 1);

/** The extension in lower case, without the dot. */
export const extension = (path: string): string => /\.([^./]+)$/.exec(path)?.[1]?.toLowerCase() ?? "";

/** The base name without its extension. */
export const stem = (path: string): string => baseName(path).replace(/\.[^.]+$/, "");

export const fromFile = (file: File, path = file.webkitRelativePath || file.name): NamedFile => ({
  path,
  bytes: async () => new Uint8Array(await file.arrayBuffer()),
  size: file.size,
});

/** The files of a file input. */
export const filesOf = ({ files }: HTMLInputElement): NamedFile[] => Array.from(files ?? [], (file) => fromFile(file));

/** Not metadata of operating systems and zip programs. */
export const isContent = (path: string) => !path.endsWith("/") && !/(^|\/)(__MACOSX\/|\.)/.test(path);

/** The files of a drop, with those in folders. */
export async function droppedFiles(data: DataTransfer): Promise<NamedFile[]> {
  // The browser clears the list when this function first awaits.
  const entries = Array.from(data.items).map((item) => item.webkitGetAsEntry());
  const plain = Array.from(data.files, (file) => fromFile(file));
  if (entries.every((entry) => entry === null || entry.isFile)) return plain;
  return (await Promise.all(entries.map((entry) => (entry === null ? [] : filesBelow(entry))))).flat();
}

async function filesBelow(entry: FileSystemEntry): Promise<NamedFile[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [fromFile(file, entry.fullPath.replace(/^\//, ""))];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const children: FileSystemEntry[] = [];
  for (;;) {
    // A reader returns at most a hundred entries per call.
    const batch = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (batch.length === 0) break;
    children.push(...batch);
  }
  return (await Promise.all(children.map(filesBelow))).flat().filter(({ path }) => isContent(path));
}
