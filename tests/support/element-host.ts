/** A page of a host that loads `<sim3-align>` from another origin, as from a CDN. */
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { installDir, repository } from "./environment.js";
import { serve } from "./static-server.js";

/** The folder that the tests serve. */
export const servedFolder = join(repository, "target");

/** The element of the installed package, below the served folder. */
export const elementFolder = "install-test/node_modules/sim3align/element";

/** Serves the package on another origin, and writes a page with one script tag and one element, `#a`. */
export async function crossOriginHost(): Promise<{ path: string; close(): Promise<void> }> {
  const { url, close } = await serve(servedFolder);
  const script = `<script type="module" src="${url}${elementFolder}/sim3-align.js"></script>`;
  const name = `host-${new URL(url).port}.html`;
  writeFileSync(
    join(installDir, name),
    `<!doctype html><link rel="icon" href="data:,">${script}<sim3-align id="a"></sim3-align>`,
  );
  return { path: `install-test/${name}`, close };
}
