/** The API report: what the package exports, as one text whose differences show in a review. */
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, relative, sep } from "node:path";
import { at, compiledDir, packageDir } from "./paths.mjs";

/** The committed report. */
const apiReportFile = at("docs", "api-report.txt");

/**
 * A file of declarations, as the compiler writes them: every statement begins in the first column.
 * @typedef {object} Declarations
 * @property {string} path below the package
 * @property {Map<string, string[]>} statements the statements that declare a name
 * @property {Map<string, { file: string, name: string }>} imports where the names from other files are declared; "*" is a whole file
 * @property {Map<string, { file: string | undefined, name: string }>} exports the exported names, and what they stand for here
 * @property {string[]} stars files whose names are all exported
 */

/** A name, and what is named in it: `Name.Part`. */
const word = /([\p{L}_$][\p{L}\p{N}_$]*)(?:\.([\p{L}_$][\p{L}\p{N}_$]*))?/gu;
const declaration =
  /^(?:export )?(?:default )?(?:declare )?(?:abstract )?(?:class|const enum|const|let|var|function|interface|type|enum|namespace) ([\w$]+)/;

/** @param {string} text declarations without comments */
function statementsOf(text) {
  const code = text.replace(/^[ \t]*\/\*\*?[\s\S]*?\*\/[ \t]*\n/gm, "").replace(/^\/\/.*\n/gm, "");
  return code
    .split(/\n(?=\S)(?![}\])])/)
    .map((statement) => statement.trim())
    .filter((statement) => statement !== "" && statement !== "export {};");
}

/**
 * The names in braces: `{ type A, B as C }`.
 * @param {string} list
 */
const namesIn = (list) =>
  list
    .split(",")
    .map((part) => part.trim().replace(/^type /, ""))
    .filter(Boolean)
    .map((part) => {
      const [name = "", as = name] = part.split(" as ");
      return { name, as };
    });

/**
 * @param {string} folder
 * @param {string} path
 * @returns {Declarations}
 */
function readDeclarations(folder, path) {
  /** @type {Declarations} */
  const found = { path, statements: new Map(), imports: new Map(), exports: new Map(), stars: [] };
  const target = (/** @type {string} */ specifier) => {
    const file = join(folder, dirname(path), specifier.replace(/\.js$/, ".d.ts"));
    // Types of Node and of other packages are named only.
    return specifier.startsWith(".") && existsSync(file) ? relative(folder, file).split(sep).join("/") : undefined;
  };
  for (const statement of statementsOf(readFileSync(join(folder, path), "utf8"))) {
    const link = /^(import|export) (?:type )?(?:\{([^}]*)\}|\*(?: as ([\w$]+))?)(?: from ["']([^"']+)["'])?;$/.exec(
      statement,
    );
    // Who imports an entry gets what it declares for all files, too.
    const isGlobal = statement.startsWith("declare global {");
    const name = isGlobal ? "global" : declaration.exec(statement)?.[1];
    if (link !== null) {
      const [, kind, list, star, specifier] = link;
      const file = specifier === undefined ? undefined : target(specifier);
      if (kind === "import") {
        if (file === undefined) continue;
        for (const { name, as } of namesIn(list ?? "")) found.imports.set(as, { file, name });
        if (star !== undefined) found.imports.set(star, { file, name: "*" });
      } else if (list === undefined) {
        if (file === undefined || star !== undefined) throw new Error(`${path}: ${statement} is not understood.`);
        found.stars.push(file);
      } else for (const { name, as } of namesIn(list)) found.exports.set(as, { file, name });
    } else if (name !== undefined) {
      found.statements.set(name, [...(found.statements.get(name) ?? []), statement]);
      if (isGlobal || statement.startsWith("export ")) found.exports.set(name, { file: undefined, name });
    } else if (!/^import ["']/.test(statement)) throw new Error(`${path}: ${statement} is not understood.`);
  }
  return found;
}

/**
 * The report of a built package: the names of each entry, and every declaration that they refer to, without comments.
 * @param {string} [folder] of the package
 */
export function apiReport(folder = compiledDir) {
  /** @type {{ exports: Record<string, { types?: string } | string> }} */
  const manifest = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  /** @type {Map<string, Declarations>} */
  const files = new Map();
  const fileOf = (/** @type {string} */ path) => {
    const known = files.get(path) ?? readDeclarations(folder, path);
    files.set(path, known);
    return known;
  };
  /** @type {Map<string, string>} texts by where and what they declare */
  const declared = new Map();
  /** @type {(path: string, name: string) => void} */
  const follow = (path, name) => {
    const file = fileOf(path);
    if (name === "*") {
      for (const exported of exportsOf(path)) follow(path, exported);
      return;
    }
    const statements = file.statements.get(name);
    if (statements === undefined) {
      const link = file.imports.get(name) ?? file.exports.get(name);
      if (link !== undefined && (link.file !== undefined || link.name !== name)) follow(link.file ?? path, link.name);
      else for (const star of file.stars) if (exportsOf(star).includes(name)) follow(star, name);
      return;
    }
    const key = `${path}\n${name}`;
    if (declared.has(key)) return;
    declared.set(key, statements.join("\n"));
    for (const [, used = "", part] of statements.join("\n").matchAll(word)) {
      const link = file.imports.get(used);
      // Of `import * as All`, `All.Name` refers to that name only.
      if (part !== undefined && link?.name === "*" && link.file !== undefined) follow(link.file, part);
      else if (used !== name && (file.statements.has(used) || link !== undefined)) follow(path, used);
    }
  };
  /** @type {(path: string) => string[]} */
  const exportsOf = (path) => {
    const { exports, stars } = fileOf(path);
    return [...new Set([...exports.keys(), ...stars.flatMap(exportsOf)])].sort();
  };

  const lines = [
    "The API of the package, generated from its declarations by `npm run api-report`. Not to be edited.",
    "",
  ];
  /** @type {Map<string, string>} entries by the names that they export */
  const entries = new Map();
  for (const [entry, target] of Object.entries(manifest.exports)) {
    if (typeof target === "string" || target.types === undefined) continue;
    const path = target.types.replace(/^\.\//, "");
    const names = exportsOf(path);
    const twin = entries.get(names.join());
    lines.push(`entry ${entry}`, ...(twin === undefined ? names : [`as ${twin}`]).map((name) => `  ${name}`), "");
    entries.set(names.join(), entry);
    for (const name of names) follow(path, name);
  }
  // By name: the files, between which declarations move, are not part of the API.
  const nameOf = (/** @type {string} */ key) => key.split("\n")[1] ?? "";
  const sorted = [...declared].sort(([a], [b]) => (nameOf(a) + a < nameOf(b) + b ? -1 : 1));
  for (const [, text] of sorted) lines.push(text, "");
  return lines.join("\n");
}

/** Writes the report of the built package. */
export const writeApiReport = () => writeFileSync(apiReportFile, apiReport());

/** The lines of a report with the names of each entry. @param {string} report */
const entriesOf = (report) => report.match(/^(entry .*| {2}[\w$]+)$/gm) ?? [];

/** @throws if the committed report is not that of the sources, or the package exports other names than they do */
export function checkApiReport() {
  const found = existsSync(apiReportFile) ? readFileSync(apiReportFile, "utf8") : "";
  const expected = apiReport();
  const [compiled, packaged] = [expected, apiReport(packageDir)].map((report) => entriesOf(report).join("\n"));
  if (compiled !== packaged) throw new Error("The bundled declarations export other names than the sources do.");
  if (found === expected) return;
  const [old, now] = [found, expected].map((text) => new Set(text.split("\n")));
  const gone = found.split("\n").filter((line) => !now?.has(line));
  const come = expected.split("\n").filter((line) => !old?.has(line));
  const changes = [...gone.map((line) => `- ${line}`), ...come.map((line) => `+ ${line}`)].slice(0, 40).join("\n");
  throw new Error(
    `docs/api-report.txt is out of date:\n${changes}\nRemedy: run npm run api-report, review the differences, and commit them.`,
  );
}
