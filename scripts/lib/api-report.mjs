/** The API report: the names of each entry of the package and every declaration, without comments, in one reviewable text. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { filesBelow } from "./cache.mjs";
import { at, packageDir } from "./paths.mjs";
import { holdUpToDate, rewrite } from "./rewrite.mjs";

/** The committed report. */
const file = at("docs", "api-report.txt");

/** The statements of a file of declarations, each of which begins in the first column. @param {string} path */
function statementsOf(path) {
  const code = readFileSync(path, "utf8")
    .replace(/^[ \t]*\/\*\*?[\s\S]*?\*\/[ \t]*\n/gm, "")
    .replace(/^\/\/.*\n/gm, "");
  return code.split(/\n(?=\S)(?![}\])])/).map((statement) => statement.trim());
}

/** The names that an entry exports. @param {string} types its declarations */
function namesIn(types) {
  const lists = statementsOf(join(packageDir, types)).flatMap(
    (statement) => /^export (?:type )?\{([^}]*)\}/.exec(statement)?.[1] ?? [],
  );
  const names = lists.flatMap((list) => list.split(",")).map((name) => name.replace(/^.* as |^type /, "").trim());
  return names.filter(Boolean).sort();
}

/** The report of the built package. Bundling moves declarations between files, so that they are sorted. */
function report() {
  /** @type {{ exports: Record<string, { types?: string }> }} */
  const { exports } = JSON.parse(readFileSync(join(packageDir, "package.json"), "utf8"));
  const entries = Object.entries(exports).flatMap(([entry, { types }]) =>
    types === undefined ? [] : [[`entry ${entry}`, ...namesIn(types)].join("\n  ")],
  );
  const statements = filesBelow([packageDir])
    .filter((path) => path.endsWith(".d.ts"))
    .flatMap(statementsOf);
  const isDeclaration = (/** @type {string} */ text) => text !== "" && !/^(import|export) (type )?[{*"']/.test(text);
  const declarations = [...new Set(statements.filter(isDeclaration))].sort();
  const head = "The API of the package, written from its declarations by `npm run update`. Not to be edited.";
  return `${[head, ...entries, ...declarations].join("\n\n")}\n`;
}

export const writeApiReport = () => rewrite([file], report);

/** @throws if the committed report is not that of the built package */
export const checkApiReport = () => holdUpToDate([file], report, "the declarations of the package");
