/**
 * Shorter names for what a module imports.
 *
 * wasm-bindgen ends each with sixteen random digits, which do not compress: a tenth of a kilobyte gzipped for every
 * dozen. One glue file serves one module, where the stem of the name and a number are enough.
 */
import { readFileSync, writeFileSync } from "node:fs";

/** A name of wasm-bindgen's, its stem, and the digits. */
const hashed = /__wbg_(\w+?)_[0-9a-f]{16}\b/g;

const importSection = 2;

/**
 * Renames the imports in a module and its glue.
 * @param {string} wasm the module's file
 * @param {string} glue its JavaScript
 */
export function shortenImports(wasm, glue) {
  const code = readFileSync(glue, "utf8");
  /** @type {Map<string, string>} */
  const names = new Map();
  const taken = new Set();
  for (const [name, stem = ""] of code.matchAll(hashed)) {
    if (names.has(name)) continue;
    const plain = stem.replace(/^_*(wbindgen_)?/, "");
    let short = plain;
    for (let i = 2; taken.has(short); i++) short = `${plain}${i}`;
    taken.add(short);
    names.set(name, short);
  }
  writeFileSync(wasm, renameImports(readFileSync(wasm), names));
  writeFileSync(
    glue,
    code.replaceAll(hashed, (name) => names.get(name) ?? name),
  );
}

/**
 * A module with other names for its imports.
 * @param {Uint8Array} bytes
 * @param {ReadonlyMap<string, string>} names
 */
function renameImports(bytes, names) {
  const parts = [bytes.subarray(0, 8)];
  const end = { at: 8 };
  while (end.at < bytes.length) {
    const begin = end.at;
    const id = bytes[end.at++];
    const size = number(bytes, end);
    const body = bytes.subarray(end.at, end.at + size);
    end.at += size;
    if (id !== importSection) parts.push(bytes.subarray(begin, end.at));
    else {
      const renamed = renameSection(body, names);
      parts.push(Uint8Array.of(importSection), leb128(renamed.length), renamed);
    }
  }
  return Buffer.concat(parts);
}

/**
 * The import section: module, name, and what it is. That is one number for a function, and nothing else is imported.
 * @param {Uint8Array} body
 * @param {ReadonlyMap<string, string>} names
 */
function renameSection(body, names) {
  const place = { at: 0 };
  const count = number(body, place);
  const parts = [leb128(count)];
  for (let i = 0; i < count; i++) {
    const module = text(body, place);
    const name = text(body, place);
    const kind = body[place.at++];
    if (kind !== 0)
      throw new Error(`${name} is imported and no function. Remedy: teach scripts/lib/imports.mjs its form.`);
    const type = number(body, place);
    for (const words of [module, names.get(name) ?? name]) {
      const encoded = Buffer.from(words);
      parts.push(leb128(encoded.length), encoded);
    }
    parts.push(Uint8Array.of(kind), leb128(type));
  }
  return Buffer.concat(parts);
}

/**
 * @param {Uint8Array} bytes
 * @param {{ at: number }} place
 */
function text(bytes, place) {
  const length = number(bytes, place);
  place.at += length;
  return Buffer.from(bytes.subarray(place.at - length, place.at)).toString();
}

/**
 * A number in LEB128, WebAssembly's form of numbers.
 * @param {Uint8Array} bytes
 * @param {{ at: number }} place
 */
function number(bytes, place) {
  let value = 0;
  for (let shift = 0; ; shift += 7) {
    const byte = bytes[place.at++] ?? 0;
    value |= (byte & 127) << shift;
    if (byte < 128) return value;
  }
}

/** @param {number} value */
function leb128(value) {
  const bytes = [];
  for (let rest = value; ; rest >>>= 7) {
    if (rest < 128) return Uint8Array.from([...bytes, rest]);
    bytes.push((rest & 127) | 128);
  }
}
