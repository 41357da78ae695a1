/** The documentation beside the page: the README, how it works, and the guides, as they are written. */
import { readdirSync, readFileSync } from "node:fs";
import { basename, join } from "node:path";

/**
 * Each document with its title and its file in the site. Browsers show `.txt`, and save `.md`.
 * @param {string} repository its folder
 */
export function documents(repository) {
  const guides = join(repository, "docs", "guides");
  const first = [join(repository, "README.md"), join(repository, "docs", "how-it-works.md")];
  const paths = [...first, ...readdirSync(guides).map((name) => join(guides, name))];
  return paths
    .filter((path) => path.endsWith(".md"))
    .map((path) => {
      const source = readFileSync(path, "utf8");
      const name = basename(path, ".md").toLowerCase();
      const title = /^# (.*)/.exec(source)?.[1] ?? name;
      return { title, fileName: `docs/${name}.txt`, source };
    });
}

/**
 * Writes them into the build.
 * @param {ReturnType<typeof documents>} all
 * @returns {import("vite").Plugin}
 */
export const documentation = (all) => ({
  name: "documentation",
  generateBundle() {
    for (const { fileName, source } of all) this.emitFile({ type: "asset", fileName, source });
  },
});
