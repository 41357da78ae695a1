/** The documentation beside the page: README, guides, and all that they link to, as pages of the site. */
import { existsSync, readFileSync } from "node:fs";
import { basename, dirname, join, relative, sep } from "node:path";

/** @typedef {{ path: string, title: string, fileName: string, source: string }} Document */

/** The file of a document in the site. @param {string} repository @param {string} path */
function pageOf(repository, path) {
  const parts = relative(repository, path).split(sep);
  if (parts.join("/") === "docs/README.md") return "docs/guides.html";
  const own = parts[0] === "docs" ? parts.slice(parts[1] === "guides" ? 2 : 1) : parts;
  return `docs/${own.join("-").toLowerCase().replace(/\.md$/, "")}.html`;
}

/** The file in the repository to which a link of a document refers. @param {string} from @param {string} link */
const targetOf = (from, link) => join(dirname(from), decodeURI(link.split("#")[0] ?? ""));

/** The documents to which a document links, in order. @param {string} path */
const linked = (path) =>
  Array.from(readFileSync(path, "utf8").matchAll(/\]\(([^)\s]+\.md)(?:#[^)]*)?\)/g), ([, link = ""]) => link)
    .filter((link) => !/^https?:/.test(link))
    .map((link) => targetOf(path, link))
    .filter((target) => existsSync(target));

/**
 * The documents: first README and those of docs/README.md, in the order of reading, then those to which they link.
 * @param {string} repository its folder
 */
export function documents(repository) {
  const index = join(repository, "docs", "README.md");
  const listed = new Set([join(repository, "README.md"), ...linked(index)]);
  const paths = new Set([...listed, index]);
  /** @type {Document[]} */
  const found = [];
  for (const path of paths) {
    const source = readFileSync(path, "utf8");
    const title = /^# (.*)/m.exec(source)?.[1]?.replaceAll("`", "") ?? basename(path, ".md");
    found.push({ path, title, fileName: pageOf(repository, path), source });
    for (const target of linked(path)) paths.add(target);
  }
  return { all: found, listed: found.slice(0, listed.size) };
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
      return isBlock ? `<p class="formula" tabindex="0">${text}</p>` : text;
    },
  });
  return [extension("block", /^\$\$([^$]+)\$\$(?:\n|$)/), extension("inline", /^\$(?!\s)([^$\n]+?)\$(?!\d)/)];
}

/**
 * The body of a page, and its headings.
 * @param {Document} document
 * @param {ReadonlyMap<string, string>} pages the names of pages by the paths of documents
 * @param {Map<string, string>} pictures gets the names of its pictures by their paths
 */
async function rendered({ path, source }, pages, pictures) {
  const [{ Marked, Renderer }, { default: highlighter }] = await Promise.all([
    import("marked"),
    import("highlight.js/lib/common"),
  ]);
  /** @type {{ level: number, anchor: string, text: string }[]} */
  const headings = [];
  const marked = new Marked({
    extensions: await formulas(),
    renderer: {
      heading({ tokens, depth, text }) {
        const inner = this.parser.parseInline(tokens);
        // Screen readers expect no level to be skipped.
        const level = Math.min(depth, (headings.at(-1)?.level ?? 0) + 1);
        headings.push({ level, anchor: anchorOf(text), text: inner.replace(/<[^>]*>/g, "") });
        return `<h${level} id="${anchorOf(text)}">${inner}</h${level}>\n`;
      },
      // Without a language, blocks are commands and layouts of folders.
      code({ text, lang = "" }) {
        const language = lang.split(" ")[0] || (/^ *(npm|npx|node|pip) /m.test(text) ? "bash" : "");
        const isKnown = highlighter.getLanguage(language) !== undefined;
        const inner = isKnown ? highlighter.highlight(text, { language }).value : escaped(text);
        return `<pre tabindex="0"><code>${inner}</code></pre>\n`;
      },
      // A flag does not break after its hyphens.
      codespan({ text }) {
        const inner = escaped(text).replace(/(?<!\S)-[\w-]+/g, (flag) => `<span class="flag">${flag}</span>`);
        return `<code>${inner}</code>`;
      },
      table(token) {
        return `<div class="table" tabindex="0">${Renderer.prototype.table.call(this, token)}</div>\n`;
      },
      // An empty cell is no header.
      tablecell(token) {
        return Renderer.prototype.tablecell.call(this, { ...token, header: token.header && token.text !== "" });
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
  return { body: await marked.parse(source), headings };
}

/** A list of links; the current page is marked. @param {readonly (readonly [address: string, text: string])[]} links */
const linkList = (links, current = "") =>
  links
    .map(
      ([address, text]) =>
        `<li><a href="${address}"${address === current ? ' aria-current="page"' : ""}>${text}</a></li>`,
    )
    .join("\n");

/**
 * A page.
 * @param {Document} document
 * @param {Awaited<ReturnType<typeof rendered>>} content
 * @param {readonly Document[]} listed
 */
function pageFor({ path, title, fileName }, { body, headings }, listed) {
  const links = listed.map((one) => /** @type {const} */ ([basename(one.fileName), escaped(one.title)]));
  const current = basename(fileName);
  const sections = headings.filter(({ level }) => level === 2 || level === 3);
  const next = links[links.findIndex(([address]) => address === current) + 1];
  // A search finds how something is used before its figures and its history.
  const weight = basename(dirname(path)) === "guides" ? 4 : 1;
  const onward = next === undefined || !links.some(([address]) => address === current) ? "" : next;
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1" />
<title>${escaped(title)} · sim3align</title>
<link rel="stylesheet" href="pagefind/pagefind-ui.css" />
<link rel="stylesheet" href="style.css" />
<script src="pagefind/pagefind-ui.js" defer></script>
<script src="script.js" defer></script>
</head>
<body>
<header><a href="../">sim3align</a><div id="search"></div></header>
<nav class="documents" aria-label="Documentation"><ul>${linkList(links, current)}</ul></nav>
<main data-pagefind-body data-pagefind-weight="${weight}">${body}${onward && `<p class="next" data-pagefind-ignore>Next: <a href="${onward[0]}">${onward[1]}</a></p>`}</main>
${
  sections.length < 2
    ? ""
    : `<nav class="sections" aria-label="On this page"><ul>${linkList(sections.map(({ anchor, text }) => [`#${anchor}`, text]))}</ul></nav>`
}
</body>
</html>
`;
}

/** The files of the search, by their names. @param {ReadonlyMap<string, string>} texts pages by their names */
async function searchFiles(texts) {
  const { close, createIndex } = await import("pagefind");
  try {
    const { errors, index } = await createIndex();
    if (index === undefined) throw new Error(errors.join(" "));
    for (const [url, content] of texts) {
      const { errors } = await index.addHTMLFile({ url, content });
      if (errors.length > 0) throw new Error(`${url}: ${errors.join(" ")}`);
    }
    const { files } = await index.getFiles();
    // Those of other interfaces are not used.
    return files.filter(({ path }) => !/modular-ui|component-ui|highlight/.test(path));
  } finally {
    await close();
  }
}

/**
 * Writes the pages, their pictures and their search into the build.
 * @param {string} www the folder of the page
 * @param {ReturnType<typeof documents>} found
 * @returns {import("vite").Plugin}
 */
export const documentation = (www, { all, listed }) => ({
  name: "documentation",
  async generateBundle() {
    const emit = (/** @type {string} */ name, /** @type {string | Uint8Array} */ source) =>
      this.emitFile({ type: "asset", fileName: `docs/${name}`, source });
    const pages = new Map(all.map(({ path, fileName }) => [path, basename(fileName)]));
    /** @type {Map<string, string>} */
    const pictures = new Map();
    /** @type {Map<string, string>} */
    const texts = new Map();
    for (const document of all) {
      const text = pageFor(document, await rendered(document, pages, pictures), listed);
      texts.set(basename(document.fileName), text);
    }
    for (const [name, text] of texts) emit(name, text);
    for (const [path, name] of pictures) emit(name, readFileSync(path));
    for (const { path, content } of await searchFiles(texts)) emit(`pagefind/${path}`, content);
    const style = ["theme", "controls", "documents"].map((name) =>
      readFileSync(join(www, `style/${name}.css`), "utf8"),
    );
    emit("style.css", style.join("\n"));
    emit("script.js", readFileSync(join(www, "documents.js"), "utf8"));
  },
});
