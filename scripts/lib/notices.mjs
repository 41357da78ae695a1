/** The licences of other people's code in the package: of the crates in the modules, and of the npm packages in the element. */
import { existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { homedir } from "node:os";
import { join } from "node:path";
import { decoderPackages } from "./decoders.mjs";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { wasmTarget } from "./setup.mjs";
import { wasmModules } from "./wasm.mjs";

/** The committed notice, which the package carries. */
export const NOTICE = "THIRD-PARTY.txt";

/** Licences that the package may carry: they ask for no more than their text. The first of several is taken. */
const allowed = ["MIT", "Apache-2.0", "Zlib", "BSD-3-Clause", "BSD-2-Clause", "ISC", "0BSD", "Unicode-3.0"];

/**
 * @typedef {object} Part
 * @property {string} name
 * @property {string} version
 * @property {string} licence an SPDX expression
 * @property {string} folder its sources
 */

/**
 * The licences that are taken of an expression, one of each part that holds with the others; `undefined` for a part of which none is
 * allowed. Cargo once wrote OR as a slash.
 * @param {string} expression
 */
const takenOf = (expression) =>
  expression.split(" AND ").map((part) => allowed.find((name) => part.match(/[\w.-]+/g)?.includes(name)));

/** The crates that the modules link, without those that only run while they are compiled. */
async function crates() {
  const selected = wasmModules.flatMap(({ crate }) => ["--package", crate]);
  const listed = await run("cargo", [
    ...["tree", "--locked", "--target", wasmTarget, "--edges", "normal,no-proc-macro", "--prefix", "none"],
    ...["--format", "{p}|{l}", ...selected],
  ]);
  const registry = join(process.env.CARGO_HOME ?? join(homedir(), ".cargo"), "registry", "src");
  const folders = readdirSync(registry).map((folder) => join(registry, folder));
  /** @type {Map<string, Part>} */
  const found = new Map();
  for (const line of listed.split("\n")) {
    const [, name = "", version = "", own, licence = ""] =
      /^(\S+) v(\S+)( \(.*\))?\|(.*?)(?: \(\*\))?$/.exec(line) ?? [];
    if (name === "" || own !== undefined) continue;
    const folder = folders.map((place) => join(place, `${name}-${version}`)).find((path) => existsSync(path));
    if (folder === undefined) throw new Error(`The sources of ${name} ${version} are missing. Remedy: cargo fetch.`);
    found.set(`${name} ${version}`, { name, version, licence, folder });
  }
  if (found.size === 0) throw new Error("cargo tree names no crate of the modules.");
  return [...found.values()].sort((a, b) => (`${a.name} ${a.version}` < `${b.name} ${b.version}` ? -1 : 1));
}

/** npm packages in the scripts of the element, whose licences the notice has. */
const bundled = ["@preact/signals", "@preact/signals-core", "preact", "three"];

/** @param {{ inputs: Readonly<Record<string, unknown>> }} metafile of esbuild */
const npmPackages = ({ inputs }) =>
  new Set(Object.keys(inputs).flatMap((path) => /.*node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1] ?? []));

/**
 * Checks that a bundle holds no npm package, or just those whose licences the notice has.
 * @param {{ inputs: Readonly<Record<string, unknown>> }} metafile of esbuild
 * @param {readonly string[]} expected
 */
function holdOnly(metafile, expected) {
  const found = [...npmPackages(metafile)].sort();
  if (found.join() === expected.join()) return;
  throw new Error(
    `A script of the package holds ${found.join(", ") || "no npm package"}, instead of ${expected.join(", ") || "none"}. Remedy: correct the list in scripts/lib/notices.mjs, and run \`npm run update\`.`,
  );
}

/** Checks that a bundle of the package holds no npm package. @param {{ inputs: Readonly<Record<string, unknown>> }} metafile */
export const refuseForeign = (metafile) => holdOnly(metafile, []);

/** Checks that the element holds those that the notice has. @param {{ inputs: Readonly<Record<string, unknown>> }} metafile */
export const allowBundled = (metafile) => holdOnly(metafile, bundled);

/** @returns {Part[]} */
const bundledParts = () =>
  [...bundled, ...decoderPackages].map((name) => {
    const folder = at("node_modules", name);
    const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    return { name, version, licence: license, folder };
  });

/**
 * The licence texts of a crate, those of what is taken if it has several.
 * @param {Part} part
 * @param {readonly string[]} taken
 */
function textsOf({ folder }, taken) {
  const files = readdirSync(folder)
    .filter((name) => /^(licen[cs]e|copying|notice)/i.test(name))
    .sort();
  const marks = taken.map((licence) => new RegExp(licence.split("-")[0] ?? licence, "i"));
  const named = files.filter((name) => marks.some((mark) => mark.test(name)));
  const chosen = named.length > 0 ? [...named, ...files.filter((name) => /^notice/i.test(name))] : files;
  return [...new Set(chosen)].map((name) =>
    readFileSync(join(folder, name), "utf8")
      .replaceAll("\r\n", "\n")
      .replace(/[ \t]+$/gm, "")
      .replace(/^\n+|\n+$/g, ""),
  );
}

const RULE = "-".repeat(80);

/** The terms of Apache-2.0, without spaces and what follows them: copies differ in these. */
const termsOf = (/** @type {string} */ text) =>
  /Apache License.*?END OF TERMS AND CONDITIONS/s.exec(text)?.[0].replace(/\s+/g, "");

/** The notice, as text. Equal texts stand once. */
async function notice() {
  /** @type {Map<string, string[]>} */
  const owners = new Map();
  const own = readFileSync(at("LICENSE-APACHE"), "utf8").trim();
  const lines = [];
  for (const part of [...(await crates()), ...bundledParts()]) {
    const title = `${part.name} ${part.version}`;
    const taken = takenOf(part.licence).filter((name) => name !== undefined);
    if (taken.length < takenOf(part.licence).length) {
      throw new Error(`${title} has the licence ${part.licence || "unknown"}. Remedy: allow it, or do without it.`);
    }
    const texts = textsOf(part, taken);
    // Some crates hold no text. That of Apache-2.0 names no owner: it is that of the package.
    const isWithout = texts.length === 0;
    if (isWithout && !part.licence.includes("Apache-2.0")) {
      throw new Error(`${title} holds no text of ${part.licence}. Remedy: add it to scripts/lib/notices.mjs.`);
    }
    lines.push(`${title.padEnd(32)} ${isWithout ? "Apache-2.0" : taken.join(" AND ")}`);
    const isOwn = (/** @type {string} */ text) => /^\s*Apache License/.test(text) && termsOf(text) === termsOf(own);
    for (const text of isWithout ? [own] : texts.map((each) => (isOwn(each) ? own : each)))
      owners.set(text, [...(owners.get(text) ?? []), title]);
  }
  const head = `Third-party notices of sim3align

The WebAssembly modules in wasm/ and inline/ hold code of the crates below, and of the standard library of Rust
(MIT OR Apache-2.0; its text is LICENSE-APACHE). The scripts in element/ hold code of the npm packages ${bundled.join(", ")}; wasm/draco.js, wasm/draco_bg.wasm and wasm/meshopt.js are those of ${decoderPackages.join(" and ")}. Where a crate can be had under several licences, that under which it is used
is named. Written by "npm run update".
`;
  const texts = [...owners].map(([text, titles]) => `${RULE}\n${titles.join(", ")}\n${RULE}\n\n${text}\n`);
  return `${head}\n${lines.join("\n")}\n\n${texts.join("\n")}`;
}

/** Writes the notice. */
export async function writeNotice() {
  writeFileSync(at(NOTICE), await notice());
}

/** Checks that the committed notice is that of what the modules link. */
export async function checkNotice() {
  if (existsSync(at(NOTICE)) && readFileSync(at(NOTICE), "utf8") === (await notice())) return;
  throw new Error(`${NOTICE} is not up to date. Remedy: \`npm run update\`, and review what has changed.`);
}
