/** Zip archives. Their directories are checked before anything is inflated, and what is inflated against them. */
import { type ErrorCode, Sim3AlignError } from "sim3align";
import type { NamedFile } from "../state/inputs.js";
import { Allowance } from "./allowance.js";
import { baseName, extension, isContent, stem } from "./files.js";
import { gathered, streamOf } from "./slices.js";

/** An archive whose directory was read. */
interface Archive {
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
  entries: readonly Entry[];
}

/** A file in an archive, as the directory describes it. */
interface Entry {
  path: string;
  isEncrypted: boolean;
  method: number;
  /** Sizes in bytes. */
  packed: number;
  inflated: number;
  /** Where its local header begins. */
  at: number;
}

/** Replaces zip archives by the files in them. */
export async function extractArchives(
  files: readonly NamedFile[],
  onProgress: (share: number) => void = () => {},
): Promise<NamedFile[]> {
  const [held, allowance] = [new Allowance(), new Allowance()];
  const isArchive = ({ path }: NamedFile) => extension(path) === "zip";
  // Archives too large to be held are not read at all.
  for (const file of files.filter(isArchive)) held.addBytes(file.size ?? 0, baseName(file.path));
  // All directories first: together, archives may be too much of which each is not.
  const parts = await Promise.all(files.map((file) => (isArchive(file) ? opened(file, allowance) : file)));
  const extracted: NamedFile[] = [];
  const total = parts.reduce((sum, part) => sum + ("entries" in part ? part.bytes.length : 0), 0);
  let done = 0;
  for (const part of parts) {
    if (!("entries" in part)) extracted.push(part);
    else {
      // What lies in no folder is in one with the name of the archive.
      const folder = part.entries.every(({ path }) => path.includes("/")) ? "" : `${stem(part.name)}/`;
      for (const entry of part.entries) {
        const content = await contentOf(part, entry);
        done += entry.packed;
        onProgress(done / total);
        extracted.push({ path: folder + entry.path, bytes: async () => content, size: content.length });
      }
    }
  }
  return extracted;
}

async function opened(file: NamedFile, allowance: Allowance): Promise<Archive> {
  const name = baseName(file.path);
  const bytes = (await file.bytes()) as Uint8Array<ArrayBuffer>;
  const entries = entriesOf(bytes, name, allowance).filter(({ path }) => isContent(path));
  for (const { path, isEncrypted, method } of entries) {
    const source = `${path} in ${name}`;
    if (extension(path) === "zip") {
      throw unsupported(`the archive ${source}`, "an archive of files", "Unpack the outer one first.");
    }
    if (isEncrypted || (method !== STORED && method !== DEFLATED)) {
      const found = `${source}, ${isEncrypted ? "encrypted" : `compressed by the method ${method}`}`;
      throw unsupported(found, "entries that are stored or deflated", "Unpack it, and drop the folder.");
    }
  }
  allowance.addArchive(
    bytes.length,
    entries.reduce((sum, { inflated }) => sum + inflated, 0),
    name,
  );
  return { name, bytes, entries };
}

const STORED = 0;
const DEFLATED = 8;

/** Signatures and sizes of the parts of the format, and the longest comment at the end. */
const END = { signature: 0x06054b50, length: 22, comment: 0xffff };
const ENTRY = { signature: 0x02014b50, length: 46 };
const LOCAL = { signature: 0x04034b50, length: 30 };

/** What the directory of an archive lists. */
function entriesOf(bytes: Uint8Array<ArrayBuffer>, name: string, allowance: Allowance): Entry[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  let end = bytes.length - END.length;
  const first = Math.max(0, end - END.comment);
  while (end >= first && view.getUint32(end, true) !== END.signature) end--;
  if (end < first) throw corrupt(`${name}, without a directory at its end`);
  const count = view.getUint16(end + 10, true);
  allowance.addFiles(count, name);
  const entries: Entry[] = [];
  let at = view.getUint32(end + 16, true);
  while (entries.length < count) {
    if (at + ENTRY.length > end || view.getUint32(at, true) !== ENTRY.signature) {
      throw corrupt(`${name}, whose directory ends after ${entries.length} of ${count} entries`);
    }
    const [flags, method] = [view.getUint16(at + 8, true), view.getUint16(at + 10, true)];
    const next = at + ENTRY.length + view.getUint16(at + 28, true);
    const path = bytes.subarray(at + ENTRY.length, next);
    entries.push({
      // A flag says whether names are UTF-8.
      path: new TextDecoder(flags & 0x800 ? "utf-8" : "latin1").decode(path),
      isEncrypted: (flags & 1) !== 0,
      method,
      packed: view.getUint32(at + 20, true),
      inflated: view.getUint32(at + 24, true),
      at: view.getUint32(at + 42, true),
    });
    at = next + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
  }
  return entries;
}

/** Inflates an entry, up to the size that the directory declares. */
async function contentOf({ name, bytes }: Archive, { path, method, packed, inflated, at }: Entry): Promise<Uint8Array> {
  const source = `${path} in ${name}`;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (at + LOCAL.length > bytes.length || view.getUint32(at, true) !== LOCAL.signature) {
    throw corrupt(`${source}, which is not where the directory says`);
  }
  const from = at + LOCAL.length + view.getUint16(at + 26, true) + view.getUint16(at + 28, true);
  if (from + packed > bytes.length) throw corrupt(`${source}, which is cut off`);
  const stream = streamOf(bytes.subarray(from, from + packed));
  const plain = method === STORED ? stream : stream.pipeThrough(new DecompressionStream("deflate-raw"));
  let left = inflated;
  const take = (length: number) => {
    left -= length;
    if (left < 0) throw corrupt(`${source}, which holds more than the ${inflated} bytes that it declares`);
  };
  const content = await gathered(plain, take).catch((cause) => {
    throw cause instanceof Sim3AlignError ? cause : corrupt(`${source}, which cannot be inflated`, cause);
  });
  if (left > 0) throw corrupt(`${source}, which holds ${content.length} of the ${inflated} bytes that it declares`);
  return content;
}

const unsupported = (found: string, expected: string, remedy: string) =>
  refusal("UNSUPPORTED_FORMAT", found, expected, remedy);

const corrupt = (found: string, cause?: unknown) =>
  refusal("CORRUPT_FILE", found, "a whole zip archive", "Download or pack it again.", cause);

function refusal(code: ErrorCode, found: string, expected: string, remedy: string, cause?: unknown): Sim3AlignError {
  return new Sim3AlignError({ code, argument: "files", found, expected, remedy }, { cause });
}
