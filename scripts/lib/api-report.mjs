/** The API report: the names of each entry of the package and every declaration, without comments, in one reviewable text. */
import { existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { at, packageDir } from "./paths.mjs";

/** The committed report. */
const file = at("docs", "api-report.txt");

/** The statements of a file of declarations, each of which begins in the first column. @param {string} path */
function statementsOf(path) {
  const text = readFileSync(join(packageDir, path), "utf8");
  const code = text.replace(/^[ \t]*\/\*\*?[\s\S]*?\*\/[ \t]*\n/gm, "").replace(/^\/\/.*\n/gm, "");
  return code.split(/\n(?=\S)(?![}\])])/).map((statement) => statement.trim());
}

/** The report of the built package. Bundling moves declarations between files, so that they are sorted. */
function report() {
  /** @type {{ exports: Record<string, { types?: string } | string> }} */
  const { exports } = JSON.parse(readFileSync(join(packageDir, "package.json"), "utf8"));
  const entries = Object.entries(exports).flatMap(([entry, target]) =>
    typeof target === "string" || target.types === undefined ? [] : [/** @type {const} */ ([entry, target.types])],
  );
  const names = entries.map(([entry, types]) => {
    const lists = statementsOf(types).flatMap(
      (statement) => /^export (?:type )?\{([^}]*)\}/.exec(statement)?.[1] ?? [],
    );
    const exported = lists.flatMap((list) => list.split(",")).map((name) => name.replace(/^.* as |^type /, "").trim());
    return [
      `entry ${entry}`,
      ...exported
        .filter(Boolean)
        .sort()
        .map((name) => `  ${name}`),
    ].join("\n");
  });
  const files = ["", "element"].flatMap((folder) =>
    readdirSync(join(packageDir, folder))
      .filter((name) => name.endsWith(".d.ts"))
      .map((name) => join(folder, name)),
  );
  const isDeclaration = (/** @type {string} */ text) => text !== "" && !/^(import|export) (type )?[{*"']/.test(text);
  const declarations = [...new Set(files.flatMap(statementsOf).filter(isDeclaration))].sort();
  const head = "The API of the package, written from its declarations by `npm run update`. Not to be edited.";
  return `${[head, ...names, ...declarations].join("\n\n")}\n`;
}

export const writeApiReport = () => writeFileSync(file, report());

/** @throws if the committed report is not that of the built package */
export function checkApiReport() {
  const [old, now] = [existsSync(file) ? readFileSync(file, "utf8") : "", report()].map((text) => text.split("\n"));
  const lines = (/** @type {string} */ mark, /** @type {string[]} */ some, /** @type {string[]} */ others) =>
    some.filter((line) => !others.includes(line)).map((line) => `${mark} ${line}`);
  const changes = [...lines("-", old ?? [], now ?? []), ...lines("+", now ?? [], old ?? [])];
  if (changes.length > 0 || old?.length !== now?.length)
    throw new Error(
      `docs/api-report.txt is out of date:\n${changes.slice(0, 40).join("\n")}\nRemedy: npm run update; review and commit.`,
    );
}
