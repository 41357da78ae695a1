/** Archives and folders, unpacked to their files. */
import { baseName, extension, fromFile, inMemory, type NamedFile } from "./named-file.js";

/** What zip programs and systems add of their own. */
const isOwn = (path: string) => !path.endsWith("/") && !/(^|\/)(__MACOSX\/|\.)/.test(path);

/** The files in a zip archive; the unpacker loads when there is one. */
async function unzipped(archive: NamedFile): Promise<NamedFile[]> {
  const { unzip } = await import("fflate");
  const bytes = await archive.bytes();
  const content = await new Promise<Record<string, Uint8Array>>((resolve, reject) => {
    unzip(bytes, (error, files) => (error ? reject(error) : resolve(files)));
  }).catch((cause: Error) => {
    throw new Error(`${baseName(archive.path)} is not a zip archive that can be read: ${cause.message}`, { cause });
  });
  return Object.entries(content).flatMap(([path, file]) => (isOwn(path) ? [inMemory(path, file)] : []));
}

/** Files, with those in zip archives in their archives' place. */
export async function unpacked(files: readonly NamedFile[]): Promise<NamedFile[]> {
  const parts = files.map((file) => (extension(file.path) === "zip" ? unzipped(file) : [file]));
  return (await Promise.all(parts)).flat();
}

/** What was dropped: files, and all that is in folders. */
export async function droppedFiles(data: DataTransfer): Promise<NamedFile[]> {
  // The list is empty as soon as this function waits for anything.
  const entries = Array.from(data.items).map((item) => item.webkitGetAsEntry());
  const plain = Array.from(data.files, (file) => fromFile(file));
  if (entries.every((entry) => entry === null || entry.isFile)) return plain;
  return (await Promise.all(entries.map((entry) => (entry === null ? [] : filesOf(entry))))).flat();
}

async function filesOf(entry: FileSystemEntry): Promise<NamedFile[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [fromFile(file, entry.fullPath.replace(/^\//, ""))];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const children: FileSystemEntry[] = [];
  for (;;) {
    // It gives a hundred at a time, at most.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) break;
    children.push(...some);
  }
  return (await Promise.all(children.map(filesOf))).flat().filter(({ path }) => isOwn(path));
}
