/** References of the documents: links, commands, names and formats of files, sizes, and the sections of the guide on errors. */
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { anchorOf } from "../../www/documentation.mjs";
import { filesBelow } from "../lib/cache.mjs";
import { at, repository } from "../lib/paths.mjs";
import { wasmModules } from "../lib/wasm.mjs";

const rootDocuments = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"].map((name) => at(name));
const isMade = (/** @type {string} */ path) => /node_modules|[\\/]dist[\\/]|examples[\\/]sample/.test(path);
const documents = () =>
  filesBelow([...rootDocuments, at("docs"), at("examples")])
    .filter((path) => path.endsWith(".md") && !isMade(path))
    .map((path) => ({ path, text: readFileSync(path, "utf8") }));

/** The anchors of headings. @param {string} text */
const anchorsIn = (text) => Array.from(text.matchAll(/^#+ (.*)$/gm), ([, title = ""]) => anchorOf(title));

/** @throws if a link leads nowhere or a command does not exist */
export function checkDocuments() {
  const { scripts } = JSON.parse(readFileSync(at("package.json"), "utf8"));
  const faults = documents().flatMap(({ path, text }) => {
    const links = Array.from(text.matchAll(/\]\(([^)\s]+)\)/g), ([, link = ""]) => link);
    const broken = links.filter((link) => {
      if (/^https?:/.test(link)) return false;
      const [file = "", anchor] = link.split("#");
      const target = file === "" ? path : join(dirname(path), file);
      if (!existsSync(target)) return true;
      return anchor !== undefined && !anchorsIn(readFileSync(target, "utf8")).includes(anchor);
    });
    // The examples have commands of their own.
    const commands = path.includes("examples") ? [] : text.matchAll(/npm run ([a-z][\w:-]*)/g);
    const unknown = Array.from(commands, ([, name = ""]) => name).filter((name) => !(name in scripts));
    return [...broken, ...unknown.map((name) => `npm run ${name}`)].map(
      (what) => `${path.slice(repository.length + 1)}: ${what}`,
    );
  });
  if (faults.length > 0) throw new Error(`These lead nowhere:\n${faults.join("\n")}\nRemedy: correct or remove them.`);
}

/** @throws if documents or comments lack a name of a file or a kind of depth, or name other formats or sizes than there are */
export async function checkNames() {
  const { build } = await import("esbuild");
  const tables = ["case-names", "input/formats", "input/depth-kinds", "input/depth-codes", "camera/keys"].map(
    (name) => `export * from "./${name}.js";`,
  );
  const stdin = { contents: tables.join("\n"), resolveDir: at("pkg-config", "src") };
  const { outputFiles } = await build({ stdin, bundle: true, write: false, format: "esm" });
  const found = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0]?.text ?? "")}`);
  const { caseNames, depthCodes, depthKinds, fileFormats, formatsText, keyTable } = found;

  const read = (/** @type {string} */ path) => readFileSync(path, "utf8");
  const parts = Object.values(caseNames).flatMap(({ stems, extensions }) => [
    ...[...stems, ...extensions.map((/** @type {string} */ ending) => `.${ending}`)],
  ]);
  const guides = documents()
    .map(({ text }) => text)
    .join("\n");
  const faults = [...new Set([...parts, ...Object.keys(depthKinds), ...Object.keys(depthCodes)])]
    .filter((name) => !new RegExp(`[\`"]${name}[\`"]`).test(guides))
    .map((name) => `The guides have no ${name}`);

  const frames = read(at("docs", "guides", "frames.md"));
  for (const { by } of keyTable)
    for (const tool of by) if (!frames.includes(tool)) faults.push(`frames.md: cameras of ${tool}`);

  const commented = ["formats.ts", "types/inputs.ts"].map((name) => ({
    path: name,
    text: read(at("pkg-config", "src", name)),
  }));
  for (const { path, text } of [...documents(), ...commented]) {
    // Such as "depth files (16-bit PNG, …)", which may go on in the next line.
    for (const [, kind = "", list = ""] of text.matchAll(/\b(\w+) files? \((\w[^().;:]*)(?=[).;:])/gi)) {
      const isList = kind.toLowerCase() in fileFormats && list.includes(",");
      if (isList && list.replace(/\s+(\* )?/g, " ") !== formatsText(kind.toLowerCase()))
        faults.push(`${path}: ${kind} files (${list})`);
    }
    // Such as "The splats module, at most 62 kB".
    for (const [all, title = "", size] of text.matchAll(
      /\bthe ([\w-]+)(?: readers| module)?(?:,| is) at most ([\d.]+) kB/gi,
    )) {
      const module = wasmModules.find(({ name }) => name === title.toLowerCase().replace("file", "formats"));
      if (module !== undefined && Math.ceil(module.budget / 1000) !== Number(size)) faults.push(`${path}: ${all}`);
    }
  }
  if (faults.length > 0)
    throw new Error(
      `${faults.join("\n")}\nRemedy: correct them; the tables are in pkg-config/src/{case-names,input/*}.ts and scripts/lib/wasm.mjs.`,
    );
}

/** @throws if the guide on errors lacks a code of an error or a warning, or has one that does not exist */
export function checkCodes() {
  const text = (/** @type {string} */ path) => readFileSync(at(...path.split("/")), "utf8");
  const guide = text("docs/guides/troubleshooting.md");
  const all = (/** @type {string} */ source, /** @type {RegExp} */ pattern) =>
    Array.from(source.matchAll(pattern), ([, code = ""]) => code);
  const [warnings = ""] = /export type WarningCode = .*/.exec(text("pkg-config/src/generated/types.ts")) ?? [];
  const errors = [
    ...all(text("runtime/src/error.rs"), /=> "([A-Z_0-9]+)"/g),
    ...all(text("pkg-config/src/values/error.ts"), /^ {2}\| "([A-Z_0-9]+)"/gm),
  ];
  for (const [level, codes] of /** @type {const} */ ([
    ["###", errors],
    ["####", all(warnings, /"([A-Z_]+)"/g)],
  ])) {
    const titles = all(guide, new RegExp(`^${level} ([A-Z_0-9]+)$`, "gm"));
    const other = [
      ...codes.filter((code) => !titles.includes(code)),
      ...titles.filter((code) => !codes.includes(code)),
    ];
    if (codes.length === 0 || other.length > 0)
      throw new Error(
        `docs/guides/troubleshooting.md disagrees on ${other.join(", ") || level}. Remedy: correct its sections.`,
      );
  }
}
