/** Keeps the user's own scenes in the browser's own database, each by its id. */
import type { NamedFile } from "../load/files.js";
import type { Packed } from "./pack.js";

const NAME = "sim3align";
/** What was done with each scene, and its files: the former changes with every step, the latter hardly ever. */
const [WORK, FILES] = ["work", "files"] as const;

/** What was done with a scene. */
export interface Work {
  id: string;
  session: Packed;
  /** Its results, as they are exported; null if it was not opened yet. */
  result: object | null;
  /** Its place in the list. */
  order: number;
  /** When it was last shown, in the milliseconds of `Date.now`; 0 if never. */
  shownAt: number;
}

/** A file in the database. */
interface StoredFile {
  path: string;
  /** As a `Blob`, which the browser stores without copying it in this thread. */
  content: Blob;
}

function database(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, 3);
    request.onupgradeneeded = () => {
      const { result } = request;
      // What another version has stored is not read.
      for (const name of [...result.objectStoreNames]) result.deleteObjectStore(name);
      for (const name of [WORK, FILES]) result.createObjectStore(name);
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** Makes requests in one transaction: all of them take effect, or none. */
async function transact(
  mode: IDBTransactionMode,
  work: (work: IDBObjectStore, files: IDBObjectStore) => IDBRequest[],
): Promise<unknown[]> {
  const opened = await database();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = opened.transaction([WORK, FILES], mode);
      const requests = work(transaction.objectStore(WORK), transaction.objectStore(FILES));
      transaction.oncomplete = () => resolve(requests.map(({ result }) => result));
      transaction.onabort = () => reject(transaction.error);
    });
  } finally {
    opened.close();
  }
}

/** Stores what was done with a scene and, if they have changed, its files. */
export async function storeWork(work: Work, files: readonly NamedFile[] | null): Promise<void> {
  const read =
    files &&
    (await Promise.all(
      files.map(async ({ path, bytes }): Promise<StoredFile> => {
        const content = (await bytes()) as Uint8Array<ArrayBuffer>;
        return { path, content: new Blob([content]) };
      }),
    ));
  await transact("readwrite", (works, contents) => [
    works.put(JSON.stringify(work), work.id),
    ...(read === null ? [] : [contents.put(read, work.id)]),
  ]);
}

/** All scenes that are stored, with those of other tabs, in their order. */
export async function storedWorks(): Promise<Work[]> {
  const [texts] = await transact("readonly", (works) => [works.getAll()]);
  return (texts as string[]).map((text) => JSON.parse(text) as Work).sort((a, b) => a.order - b.order);
}

/** The files of a scene. */
export async function storedFiles(id: string): Promise<NamedFile[]> {
  const [stored] = await transact("readonly", (_, files) => [files.get(id)]);
  return (stored as StoredFile[]).map(({ path, content }) => ({
    path,
    bytes: async () => new Uint8Array(await content.arrayBuffer()),
  }));
}

/** Forgets a scene. */
export async function forgetWork(id: string): Promise<void> {
  await transact("readwrite", (works, files) => [works.delete(id), files.delete(id)]);
}
