/** The script of a report's page, in one piece: pages from disk may not load modules. */
import { rmSync } from "node:fs";
import { join } from "node:path";
import { refuseForeign } from "./notices.mjs";
import { packageDir } from "./paths.mjs";

/** Bundles the compiler's output in pkg/. */
export async function bundleReportPage() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const folder = join(packageDir, "report-page");
  const { metafile } = await build({
    entryPoints: [join(folder, "main.js")],
    outfile: join(packageDir, "report-page.js"),
    ...{ bundle: true, minify: true, format: "iife", platform: "browser", target: "es2022", logLevel: "warning" },
    metafile: true,
  });
  refuseForeign(metafile);
  rmSync(folder, { recursive: true });
}
