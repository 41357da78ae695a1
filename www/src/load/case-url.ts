/** Files at an address: a zip archive, or a JSON index of a folder. */
import { baseName, type NamedFile } from "./files.js";

/** The first bytes of zip archives. */
const ZIP = [0x50, 0x4b] as const;

/**
 * The files at an address: those of a zip archive (a case or scene folder, or a session), or those that a JSON index lists
 * as `{ "files": ["depth.png", …] }`, each relative to the address of the index.
 */
export async function filesAt(url: string): Promise<NamedFile[]> {
  const address = new URL(url, document.baseURI);
  const bytes = await fetched(address);
  if (bytes[0] === ZIP[0] && bytes[1] === ZIP[1]) {
    const path = baseName(address.pathname);
    return [{ path: path.endsWith(".zip") ? path : `${path}.zip`, bytes: async () => bytes }];
  }
  const folder = address.pathname.split("/").at(-2) ?? "";
  return indexed(bytes, address).map((path) => ({
    path: `${folder}/${path}`,
    bytes: () => fetched(new URL(path, address)),
  }));
}

async function fetched(address: URL): Promise<Uint8Array> {
  const response = await fetch(address).catch(() => {
    throw new Error(`${address.href} could not be loaded: its server must be reachable, and allow this page (CORS).`);
  });
  if (!response.ok) throw new Error(`${address.href} could not be loaded: HTTP ${response.status}.`);
  return new Uint8Array(await response.arrayBuffer());
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
