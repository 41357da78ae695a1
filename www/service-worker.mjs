/** The service worker of the page: the build names the files that it stores. */
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join, posix, sep } from "node:path";

/** The files below a folder, by their names in the site. @param {string} folder @param {string} name @returns {[string, Buffer][]} */
const filesBelow = (folder, name) =>
  readdirSync(folder, { recursive: true, encoding: "utf8" })
    .sort()
    .filter((path) => statSync(join(folder, path)).isFile())
    .map((path) => [posix.join(name, ...path.split(sep)), readFileSync(join(folder, path))]);

/**
 * Writes the service worker for all files of the build and the samples.
 * @param {string} www the folder of the page
 * @returns {import("vite").Plugin}
 */
export const serviceWorker = (www) => ({
  name: "service-worker",
  generateBundle: {
    order: "post",
    handler(_, bundle) {
      const built = Object.values(bundle).map((file) => [
        file.fileName,
        Buffer.from(file.type === "asset" ? file.source : file.code),
      ]);
      const files = [...built, ...filesBelow(join(www, "samples"), "samples")];
      const hash = createHash("sha256");
      for (const [name = "", content = ""] of files) hash.update(name).update(content);
      const names = ["./", ...files.map(([name]) => String(name))];
      const source = readFileSync(join(www, "src", "offline", "service-worker.js"), "utf8");
      this.emitFile({
        type: "asset",
        fileName: "service-worker.js",
        source: `const BUILD = "${hash.digest("hex").slice(0, 16)}";\nconst FILES = ${JSON.stringify(names)};\n${source}`,
      });
    },
  },
});
