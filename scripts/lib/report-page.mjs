/** The script of a report's page, in one piece: pages from disk may not load modules. */
import { join } from "node:path";
import { refuseForeign } from "./notices.mjs";
import { compiledDir, packageDir } from "./paths.mjs";

/** Bundles the compiler's output. */
export async function bundleReportPage() {
  // The set-up installs it first.
  const { build } = await import("esbuild");
  const { metafile } = await build({
    entryPoints: [join(compiledDir, "report-page", "main.js")],
    outfile: join(packageDir, "report-page.js"),
    ...{ bundle: true, minify: true, format: "iife", platform: "browser", target: "es2022", logLevel: "warning" },
    metafile: true,
  });
  refuseForeign(metafile);
}
