/** The examples in the documentation: fenced blocks of TypeScript and JavaScript. */
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { repository } from "./environment.js";

/** A fenced block. */
export interface Example {
  /** The place of its first line: `docs/guides/frames.md:12`. */
  place: string;
  /** A name for its file. */
  name: string;
  /** Its text as a module, on the same lines as in the document. */
  module: string;
  /** Whether it can be run, too; blocks marked `no-run` after the language are compiled only. */
  isRun: boolean;
  /** The code of the error that it is about; of blocks marked `throws CODE`. */
  throws: string | undefined;
}

/** The documents that have examples. */
function documents(): string[] {
  const guides = join("docs", "guides");
  const names = existsSync(join(repository, guides)) ? readdirSync(join(repository, guides)).sort() : [];
  return ["README.md", ...names.filter((name) => name.endsWith(".md")).map((name) => join(guides, name))];
}

/** All examples, in order. */
export function examples(): Example[] {
  return documents().flatMap((path) => {
    const lines = readFileSync(join(repository, path), "utf8").split("\n");
    const found: Example[] = [];
    for (let i = 0; i < lines.length; i++) {
      const opening = /^```(?:ts|js)\b(.*)$/.exec(lines[i] ?? "");
      if (opening === null) continue;
      const first = i + 1;
      while (i + 1 < lines.length && lines[i + 1] !== "```") i += 1;
      const code = lines.slice(first, i + 1).join("\n");
      found.push({
        place: `${path}:${first}`,
        name: `${path.replace(/\W+/g, "-")}-${first}`,
        // Errors then name the document's own lines; what follows makes it a module in any case.
        module: `${"\n".repeat(first)}${code}\nexport {};\n`,
        isRun: !/\bno-run\b/.test(opening[1] ?? ""),
        throws: /\bthrows (\w+)/.exec(opening[1] ?? "")?.[1],
      });
    }
    return found;
  });
}
