/** Keeps the user's own scenes in the browser's own database, each by its id. */
import type { NamedFile } from "../state/inputs.js";
import { TAB } from "./owner.js";
import type { Packed } from "./pack.js";

const NAME = "sim3align";
/** The first version whose content is read. */
const VERSION = 3;
/** What was done with each scene, and its files: the former changes with every step, the latter hardly ever. */
const [WORK, FILES] = ["work", "files"] as const;
/** The tab that may change each scene. */
const OWNERS = "owners";
const stores = [WORK, FILES, OWNERS];

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
    const request = indexedDB.open(NAME, VERSION + 1);
    request.onupgradeneeded = ({ oldVersion }) => {
      const { result } = request;
      if (oldVersion < VERSION) for (const name of [...result.objectStoreNames]) result.deleteObjectStore(name);
      for (const name of stores) if (!result.objectStoreNames.contains(name)) result.createObjectStore(name);
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** Makes requests in one transaction: all of them take effect, or none. */
async function transact(
  mode: IDBTransactionMode,
  work: (...stores: [work: IDBObjectStore, files: IDBObjectStore, owners: IDBObjectStore]) => IDBRequest[],
): Promise<unknown[]> {
  const opened = await database();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = opened.transaction(stores, mode);
      const store = (name: string) => transaction.objectStore(name);
      const requests = work(store(WORK), store(FILES), store(OWNERS));
      transaction.oncomplete = () => resolve(requests.map(({ result }) => result));
      transaction.onabort = () => reject(transaction.error);
    });
  } finally {
    opened.close();
  }
}

/** Makes a scene that of this tab: no other one can store it from then on. */
export async function claimWork(id: string): Promise<void> {
  await transact("readwrite", (_works, _contents, owners) => [owners.put(TAB, id)]);
}

/**
 * Stores what was done with a scene of this tab and, if they have changed, its files. Returns false, and stores nothing, if
 * another tab has taken it over.
 */
export async function storeWork(work: Work, files: readonly NamedFile[] | null): Promise<boolean> {
  const { id } = work;
  const read: StoredFile[] | null = files && [];
  // One after the other: those of a video together may be more than this thread can hold.
  for (const { path, bytes } of files ?? [])
    read?.push({ path, content: new Blob([(await bytes()) as Uint8Array<ArrayBuffer>]) });
  const [owner] = await transact("readwrite", (works, contents, owners) => {
    const found = owners.get(id);
    found.addEventListener("success", () => {
      if (isOthers(found.result)) return;
      owners.put(TAB, id);
      works.put(JSON.stringify(work), id);
      if (read !== null) contents.put(read, id);
    });
    return [found];
  });
  return !isOthers(owner);
}

const isOthers = (owner: unknown) => owner !== undefined && owner !== TAB;

/** A scene that is stored. */
export async function storedWork(id: string): Promise<Work | null> {
  const [text] = await transact("readonly", (works) => [works.get(id)]);
  return text === undefined ? null : (JSON.parse(text as string) as Work);
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
  await transact("readwrite", (...all) => all.map((store) => store.delete(id)));
}
