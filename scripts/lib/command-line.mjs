/** The command line program, in one file: Node starts it a tenth sooner than fifty. */
import { chmodSync, readdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { refuseForeign } from "./notices.mjs";
import { packageDir } from "./paths.mjs";

/** Bundles the compiler's output in pkg/cli/. What the program shares with the library stays in the library's files. */
export async function bundleCommandLine() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const folder = join(packageDir, "cli");
  const main = join(folder, "main.js");
  const { metafile } = await build({
    entryPoints: [main],
    outfile: main,
    allowOverwrite: true,
    ...{ bundle: true, format: "esm", platform: "node", target: "es2022", logLevel: "warning" },
    external: ["commander", "tinyglobby"],
    metafile: true,
    plugins: [
      {
        name: "library",
        setup: ({ onResolve }) => onResolve({ filter: /^\.\.\// }, ({ path }) => ({ path, external: true })),
      },
    ],
  });
  refuseForeign(metafile);
  for (const file of readdirSync(folder)) if (file !== "main.js") rmSync(join(folder, file));
  chmodSync(main, 0o755);
}
