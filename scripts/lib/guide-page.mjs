/** The guide that the page refers to, as a page of the site. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { at } from "./paths.mjs";

/**
 * Writes a guide as a page that shows its text.
 * @param {string} name
 * @param {string} to the file
 */
export function writeGuidePage(name, to) {
  const text = readFileSync(at("docs", "guides", `${name}.md`), "utf8");
  const title = /^# (.*)$/m.exec(text)?.[1] ?? name;
  const escaped = text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  const style =
    "body { max-width: 62rem; margin: 2rem auto; padding: 0 1rem } pre { white-space: pre-wrap; font-size: 1rem }";
  const head = `<meta charset="utf-8"><meta name="color-scheme" content="light dark"><title>${title}</title><style>${style}</style>`;
  mkdirSync(dirname(to), { recursive: true });
  writeFileSync(to, `<!doctype html><html lang="en"><head>${head}</head><body><pre>${escaped}</pre></body></html>\n`);
}
