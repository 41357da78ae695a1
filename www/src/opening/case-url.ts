/** Files at an address: a zip archive, or a JSON index of a folder. */
import { Allowance } from "../input/allowance.js";
import { baseName } from "../input/files.js";
import { gathered } from "../input/slices.js";
import type { NamedFile } from "../state/inputs.js";

/** The first bytes of zip archives. */
const ZIP = [0x50, 0x4b] as const;

/**
 * The files at an address: those of a zip archive (a case or scene folder, or a session), or those that a JSON index lists
 * as `{ "files": ["depth.png", …] }`, each relative to the address of the index.
 */
export async function filesAt(url: string): Promise<NamedFile[]> {
  const address = new URL(url, document.baseURI);
  const allowance = new Allowance();
  const bytes = await fetched(address, allowance);
  if (bytes[0] === ZIP[0] && bytes[1] === ZIP[1]) {
    const path = baseName(address.pathname);
    return [{ path: path.endsWith(".zip") ? path : `${path}.zip`, bytes: async () => bytes }];
  }
  const folder = address.pathname.split("/").at(-2) ?? "";
  const paths = indexed(bytes, address);
  allowance.addFiles(paths.length, address.href);
  return paths.map((path) => {
    // Kept, so that each file is loaded and counted once.
    let content: Promise<Uint8Array> | undefined;
    const load = () => {
      content ??= fetched(new URL(path, address), allowance);
      return content;
    };
    return { path: `${folder}/${path}`, bytes: load };
  });
}

/** Loads an address. What a server says of the size is not relied on: it may compress, or lie. */
async function fetched(address: URL, allowance: Allowance): Promise<Uint8Array> {
  const response = await fetch(address).catch(() => {
    throw new Error(`${address.href} could not be loaded: its server must be reachable, and allow this page (CORS).`);
  });
  if (!response.ok) throw new Error(`${address.href} could not be loaded: HTTP ${response.status}.`);
  return gathered(response.body ?? new ReadableStream(), (length) => allowance.addBytes(length, address.href));
}

/** The paths that an index lists. */
function indexed(bytes: Uint8Array, address: URL): string[] {
  let files: unknown;
  try {
    files = (JSON.parse(new TextDecoder().decode(bytes)) as { files?: unknown }).files;
  } catch {
    // Neither JSON nor an archive: the message below says what is expected.
  }
  if (Array.isArray(files) && files.length > 0 && files.every((path) => typeof path === "string")) return files;
  throw new Error(`${address.href} is neither a zip archive nor an index such as { "files": ["depth.png", …] }.`);
}
