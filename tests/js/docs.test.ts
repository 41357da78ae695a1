/**
 * The documentation's examples: all are compiled, and all but those marked `no-run` are run. Those marked `throws CODE`
 * have to fail with that error.
 */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { docsScene } from "../support/docs-scene.js";
import { installDir, repository } from "../support/environment.js";

/** A fenced block. */
interface Example {
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
  const names = readdirSync(join(repository, guides)).sort();
  return ["README.md", ...names.filter((name) => name.endsWith(".md")).map((name) => join(guides, name))];
}

/** All examples, in order. */
function examples(): Example[] {
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

const found = examples();
const folder = join(installDir, "docs-examples");
const errors = compile();
Object.assign(globalThis, docsScene);
// Examples read the sample that the guides copy into the working directory.
cpSync(join(installDir, "node_modules", "sim3align", "sample"), join(folder, "mug"), { recursive: true });
process.chdir(folder);
// The runner reads its messages from standard output, and loses the file when an example's own output cuts one in two.
for (const method of ["log", "info", "warn", "error", "table"] as const) console[method] = () => {};

/** Compiles all examples; the compiler's messages by the example's name. */
function compile(): Map<string, string[]> {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  for (const { name, module } of found) writeFileSync(join(folder, `${name}.ts`), module);
  const globals = Object.keys(docsScene).map((name) => `  var ${name}: (typeof docsScene)["${name}"];\n`);
  const imported = 'import type { docsScene } from "../tests/support/docs-scene.js";';
  writeFileSync(join(folder, "globals.ts"), `${imported}\ndeclare global {\n${globals.join("")}}\n`);
  const tsconfig = {
    extends: join(repository, "tests", "tsconfig.installed.json"),
    // An example shows a value; it need not use it.
    compilerOptions: { noUnusedLocals: false, outDir: "out", rootDir: "..", sourceMap: false },
    include: ["*.ts", "../tests/support/wasm.d.ts"],
  };
  writeFileSync(join(folder, "tsconfig.json"), JSON.stringify(tsconfig));
  const tsc = join(repository, "node_modules", "typescript", "bin", "tsc");
  const { stdout } = spawnSync(process.execPath, [tsc, "--pretty", "false", "--project", folder], {
    cwd: folder,
    encoding: "utf8",
  });
  const messages = new Map<string, string[]>();
  for (const line of stdout.split("\n").filter((line) => /error TS/.test(line))) {
    const name = /^(?:.*\/)?([\w-]+)\.ts\(/.exec(line)?.[1] ?? "";
    messages.set(name, [...(messages.get(name) ?? []), line]);
  }
  return messages;
}

test("there are examples, and the compiler finds nothing else to say", () => {
  assert.ok(found.length > 0);
  const names = found.map(({ name }) => name);
  const others = [...errors].filter(([name]) => !names.includes(name));
  assert.deepEqual(others, []);
});

for (const { place, name, isRun, throws } of found) {
  const end = throws === undefined ? " and runs" : `, and throws ${throws}`;
  test(`${place} compiles${isRun ? end : ""}`, async () => {
    assert.deepEqual(errors.get(name) ?? [], []);
    if (!isRun) return;
    const run = import(pathToFileURL(join(folder, "out", "docs-examples", `${name}.js`)).href);
    if (throws === undefined) await run;
    else await assert.rejects(run, { name: "Sim3AlignError", code: throws });
  });
}
