/** The documentation beside the page: README, guides, and all that they link to, as pages of the site. */
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { basename, dirname, join, relative, sep } from "node:path";

/** @typedef {{ path: string, title: string, fileName: string, source: string }} Document */

/** The file of a document in the site. @param {string} repository @param {string} path */
function pageOf(repository, path) {
  const parts = relative(repository, path).split(sep);
  const own = parts[0] === "docs" ? parts.slice(parts[1] === "guides" ? 2 : 1) : parts;
  return `docs/${own.join("-").toLowerCase().replace(/\.md$/, "")}.html`;
}

/** The file in the repository to which a link of a document refers. @param {string} from @param {string} link */
const targetOf = (from, link) => join(dirname(from), decodeURI(link.split("#")[0] ?? ""));

/**
 * The documents: first those that the help of the page lists, then those to which they link.
 * @param {string} repository its folder
 */
export function documents(repository) {
  const guides = join(repository, "docs", "guides");
  const listed = [join(repository, "README.md"), join(repository, "docs", "how-it-works.md")];
  for (const name of readdirSync(guides)) if (name.endsWith(".md")) listed.push(join(guides, name));
  const paths = new Set(listed);
  /** @type {Document[]} */
  const found = [];
  for (const path of paths) {
    const source = readFileSync(path, "utf8");
    const title = /^# (.*)/m.exec(source)?.[1]?.replaceAll("`", "") ?? basename(path, ".md");
    found.push({ path, title, fileName: pageOf(repository, path), source });
    for (const [, link = ""] of source.matchAll(/\]\(([^)\s]+\.md)(?:#[^)]*)?\)/g)) {
      const target = targetOf(path, link);
      if (!/^https?:/.test(link) && existsSync(target)) paths.add(target);
    }
  }
  return { all: found, listed: found.slice(0, listed.length) };
}

/** The anchor of a heading, as GitHub and npm make it. @param {string} title */
export const anchorOf = (title) =>
  title
    .toLowerCase()
    .replace(/[^\p{L}\p{N} _-]/gu, "")
    .replaceAll(" ", "-");

const escaped = (/** @type {string} */ text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);

/** Formulas between dollars, in display or in a line, as MathML. */
async function formulas() {
  const { default: katex } = await import("katex");
  const extension = (/** @type {"block" | "inline"} */ level, /** @type {RegExp} */ pattern) => ({
    name: `formula-${level}`,
    level,
    start: (/** @type {string} */ text) => {
      const at = text.indexOf("$");
      return at < 0 ? undefined : at;
    },
    tokenizer(/** @type {string} */ text) {
      const [raw, formula] = pattern.exec(text) ?? [];
      return raw === undefined ? undefined : { type: `formula-${level}`, raw, formula };
    },
    renderer({ formula = "" }) {
      const isBlock = level === "block";
      const text = katex.renderToString(formula, { displayMode: isBlock, output: "mathml", throwOnError: true });
      return isBlock ? `<p>${text}</p>` : text;
    },
  });
  return [extension("block", /^\$\$([^$]+)\$\$(?:\n|$)/), extension("inline", /^\$(?!\s)([^$\n]+?)\$(?!\d)/)];
}

/**
 * Writes the pages and their pictures into the build.
 * @param {string} www the folder of the page
 * @param {ReturnType<typeof documents>} found
 * @returns {import("vite").Plugin}
 */
export const documentation = (www, { all, listed }) => ({
  name: "documentation",
  async generateBundle() {
    const { Marked } = await import("marked");
    const pages = new Map(all.map(({ path, fileName }) => [path, basename(fileName)]));
    /** @type {Map<string, string>} */
    const pictures = new Map();
    const style = ["theme.css", "documents.css"].map((name) => readFileSync(join(www, "style", name), "utf8"));
    this.emitFile({ type: "asset", fileName: "docs/style.css", source: style.join("\n") });
    const extensions = await formulas();
    for (const { path, title, fileName, source } of all) {
      const marked = new Marked({
        extensions,
        renderer: {
          heading({ tokens, depth, text }) {
            return `<h${depth} id="${anchorOf(text)}">${this.parser.parseInline(tokens)}</h${depth}>\n`;
          },
          link({ href, tokens }) {
            const text = this.parser.parseInline(tokens);
            if (/^(https?:|#)/.test(href)) return `<a href="${escaped(href)}">${text}</a>`;
            const page = pages.get(targetOf(path, href));
            const [, anchor] = href.split("#");
            // Files of the repository that are no document are not part of the site.
            return page === undefined ? text : `<a href="${page}${anchor ? `#${anchor}` : ""}">${text}</a>`;
          },
          image({ href, text }) {
            const target = targetOf(path, href);
            pictures.set(target, basename(target));
            return `<img src="${basename(target)}" alt="${escaped(text)}" loading="lazy" />`;
          },
        },
      });
      const body = await marked.parse(source);
      const items = listed.map((one) => {
        const current = one.path === path ? ' aria-current="page"' : "";
        return `<li><a href="${basename(one.fileName)}"${current}>${escaped(one.title)}</a></li>`;
      });
      const page = `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1" />
<title>${escaped(title)} · sim3align</title>
<link rel="stylesheet" href="style.css" />
</head>
<body>
<header><a href="../">sim3align</a></header>
<nav aria-label="Documentation"><ul>${items.join("\n")}</ul></nav>
<main>${body}</main>
</body>
</html>
`;
      this.emitFile({ type: "asset", fileName, source: page });
    }
    for (const [path, name] of pictures) {
      this.emitFile({ type: "asset", fileName: `docs/${name}`, source: readFileSync(path) });
    }
  },
});
