/** The documentation: the page's help opens it, and no link of it is dead. */
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { violations } from "../support/browser.js";
import { PATIENCE, pageTests, siteDir } from "../support/site.js";

const test = pageTests();

/** Runs in the page: what a document links to and shows, its anchors, and formulas that were left as they are written. */
const parts = `async (address) => {
  const text = await (await fetch(address)).text();
  const page = new DOMParser().parseFromString(text, "text/html");
  const all = (selector, name) => [...page.querySelectorAll(selector)].map((one) => one.getAttribute(name));
  for (const code of page.querySelectorAll("code, annotation")) code.remove();
  return {
    title: page.querySelector("h1")?.textContent ?? "",
    links: all("a[href]", "href"),
    pictures: all("img[src], link[href]", "src").filter(Boolean),
    anchors: all("[id]", "id"),
    isRaw: /\\$\\$|\\]\\(/.test(page.querySelector("main").textContent),
  };
}`;

interface Parts {
  title: string;
  links: string[];
  pictures: string[];
  anchors: string[];
  isRaw: boolean;
}

test("the help opens documents as pages, and each of their links leads somewhere", async (opened, page) => {
  await opened.press("Help");
  const [document] = await Promise.all([
    page.waitForEvent("popup"),
    page.locator(".documents a", { hasText: "Frames" }).first().click(),
  ]);
  await document.locator("main h1").waitFor();
  assert.ok((await document.locator("nav a").count()) > 10);
  const files = readdirSync(join(siteDir, "docs"));
  const pages = files.filter((name) => name.endsWith(".html"));
  const found = new Map<string, Parts>();
  for (const name of pages) found.set(name, (await document.evaluate(`(${parts})("${name}")`)) as Parts);
  const dead = [...found].flatMap(([name, { anchors, isRaw, links, pictures, title }]) => {
    const isDead = (link: string) => {
      const [file = "", anchor] = link.split("#");
      if (/^https?:/.test(link) || link === "../") return false;
      const target = file === "" ? anchors : found.get(file)?.anchors;
      return target === undefined || (anchor !== undefined && !target.includes(anchor));
    };
    const missing = pictures.filter((picture) => !files.includes(picture));
    return [
      ...[...links.filter(isDead), ...missing].map((what) => `${name}: ${what}`),
      ...(isRaw || title === "" ? [`${name}: not rendered`] : []),
    ];
  });
  assert.deepEqual(dead, []);
});

test("documents have no accessibility violations, find words, and let code be copied", async (_, page) => {
  const names = readdirSync(join(siteDir, "docs")).filter((name) => name.endsWith(".html"));
  for (const name of names) {
    await page.goto(new URL(`docs/${name}`, page.url().replace(/docs\/.*|index.html.*/, "")).href);
    await page.locator("#search input").waitFor(PATIENCE);
    assert.deepEqual(await violations(page), [], name);
  }
  const search = page.getByRole("textbox", { name: "Search" });
  const results = page.locator(".pagefind-ui__result-link");
  await search.fill("alignScene");
  await results.first().filter({ hasText: "Scenes, and outputs of generators" }).waitFor(PATIENCE);

  await search.fill("quaternion");
  await results.filter({ hasText: "Matrices and quaternions" }).click(PATIENCE);
  await page.locator("#matrices-and-quaternions").waitFor(PATIENCE);
  assert.match(page.url(), /docs\/frames\.html/);

  await page.goto(new URL("first-alignment.html", page.url()).href);
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.locator(".code", { hasText: "npm install sim3align" }).getByRole("button", { name: "Copy" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor(PATIENCE);
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^mkdir first && cd first\n/);
});
