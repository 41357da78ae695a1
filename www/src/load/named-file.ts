/** Files as they are chosen, dropped, unzipped or fetched. */

/** A file with its path in the folder or archive that it came in. */
export interface NamedFile {
  path: string;
  /** What it shows, where that is known. */
  title?: string;
  bytes(): Promise<Uint8Array>;
}

/** The part of a path after its last slash. */
export const baseName = (path: string): string => path.slice(path.lastIndexOf("/") + 1);

/** A name's extension, in small letters, without its point. */
export const extension = (path: string): string => /\.([^./]+)$/.exec(path)?.[1]?.toLowerCase() ?? "";

/** A name without its extension. */
export const stem = (path: string): string => baseName(path).replace(/\.[^.]+$/, "");

export const fromFile = (file: File, path = file.webkitRelativePath || file.name): NamedFile => ({
  path,
  bytes: async () => new Uint8Array(await file.arrayBuffer()),
});

/** A file that is in memory. */
export const inMemory = (path: string, content: Uint8Array): NamedFile => ({ path, bytes: async () => content });
