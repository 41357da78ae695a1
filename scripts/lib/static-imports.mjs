/** What a script needs before its first line runs: the packages in its static imports, and in theirs. */
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";

const statement = /^(?:import|export)\b[^;]*?\bfrom "([^"]+)"|^import "([^"]+)"/gm;

/**
 * The npm packages that a module and the modules of ours that it imports, import statically, each with its importer.
 * @param {string} path
 * @param {Set<string>} [seen] modules that were looked at already
 * @returns {{ name: string, importer: string }[]}
 */
export function staticPackages(path, seen = new Set()) {
  if (seen.has(path)) return [];
  seen.add(path);
  const names = [...readFileSync(path, "utf8").matchAll(statement)].map((found) => found[1] ?? found[2] ?? "");
  return names.flatMap((name) => {
    if (name.startsWith(".")) return staticPackages(join(dirname(path), name), seen);
    return name.startsWith("node:") ? [] : [{ name, importer: path }];
  });
}
