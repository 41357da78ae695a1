/** Keeps one session in the browser's own database. */
import type { NamedFile } from "../load/files.js";
import type { Packed } from "./pack.js";

const NAME = "sim3align";
const STORE = "session";

/** A file in the database. */
interface StoredFile {
  path: string;
  /** As a `Blob`, which the browser stores without copying it in this thread. */
  content: Blob;
}

function database(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, 2);
    request.onupgradeneeded = () => {
      // What another version has stored is not read.
      if (request.result.objectStoreNames.contains(STORE)) request.result.deleteObjectStore(STORE);
      request.result.createObjectStore(STORE);
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

async function transact<T>(mode: IDBTransactionMode, work: (store: IDBObjectStore) => IDBRequest<T>[]): Promise<T[]> {
  const opened = await database();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = opened.transaction(STORE, mode);
      const requests = work(transaction.objectStore(STORE));
      transaction.oncomplete = () => resolve(requests.map(({ result }) => result));
      transaction.onabort = () => reject(transaction.error);
    });
  } finally {
    opened.close();
  }
}

/** Stores the files of a new scene. */
export async function storeFiles(files: readonly NamedFile[]): Promise<void> {
  const read = await Promise.all(
    files.map(async ({ path, bytes }): Promise<StoredFile> => {
      const content = (await bytes()) as Uint8Array<ArrayBuffer>;
      return { path, content: new Blob([content]) };
    }),
  );
  await transact("readwrite", (store) => [store.put(read, "files")]);
}

/** Stores what was done with the objects. */
export async function storeSession(session: Packed): Promise<void> {
  await transact("readwrite", (store) => [store.put(JSON.stringify(session), "session")]);
}

export async function storedSession(): Promise<{ session: Packed; files: NamedFile[] } | null> {
  const [text, stored] = await transact<unknown>("readonly", (store) => [store.get("session"), store.get("files")]);
  if (typeof text !== "string" || !Array.isArray(stored)) return null;
  const files = (stored as StoredFile[]).map(({ path, content }) => ({
    path,
    bytes: async () => new Uint8Array(await content.arrayBuffer()),
  }));
  return { session: JSON.parse(text) as Packed, files };
}

export async function clearSession(): Promise<void> {
  await transact("readwrite", (store) => [store.clear()] as IDBRequest<undefined>[]);
}
