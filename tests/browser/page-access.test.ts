/** Accessibility: axe, keyboard, phones, light and dark themes. */
import assert from "node:assert/strict";
import type { BrowserContextOptions } from "playwright-core";
import { WEBGL } from "../support/browser.js";
import { drop, files } from "../support/page-files.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests(WEBGL);

const phone = { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true } satisfies BrowserContextOptions;

/** Opens all disclosures, and checks the page with them, and the help. */
async function assertAccessible(opened: SitePage): Promise<void> {
  const { page } = opened;
  for (const summary of await page.locator("details:not([open]) > summary").all()) {
    if (await summary.isVisible()) await summary.click();
  }
  assert.deepEqual(await opened.violations(), []);
  await page.locator(".tools").getByRole("button", { name: "Help" }).click();
  assert.deepEqual(await opened.violations(), []);
  await page.keyboard.press("Escape");
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(overflow <= 0, `the page is ${overflow} pixels wider than the window`);
}

const laptop = { address: "#sample=desk", viewport: { width: 1280, height: 800 } };
test("axe finds nothing on a laptop", laptop, (opened) => assertAccessible(opened));

test("axe finds nothing on the intake sheet", phone, async (opened) => {
  const { "camera.json": _, ...rest } = files;
  const { "mesh.obj": mesh, "mask.png": mask } = rest;
  // Two objects whose names do not tell that they belong together, and no camera.
  await drop(opened, { ...rest, "mask-b.png": mask as Uint8Array, "other.obj": mesh as Uint8Array });
  const sheet = await opened.sheet();
  await sheet.locator(".file-roles summary").click();
  assert.deepEqual(await opened.violations(), []);
});

test("all controls are reachable by keyboard and show their focus", async ({ page }) => {
  const reached = new Set<string>();
  for (let i = 0; i < 120; i++) {
    await page.keyboard.press("Tab");
    const found = (await page.evaluate(() => {
      const element = document.activeElement;
      if (!(element instanceof HTMLElement) || element === document.body) return null;
      const outlined = element.closest(".button") ?? element;
      const label = element.id || element.getAttribute("aria-label") || element.textContent?.trim() || element.tagName;
      return { label, outline: getComputedStyle(outlined).outlineStyle };
    })) as { label: string; outline: string } | null;
    if (found === null) break;
    assert.notEqual(found.outline, "none", `${found.label} does not show its focus`);
    reached.add(found.label);
  }
  for (const name of ["help", "align", "hand-title", "JSON", "files", "wipe", "accept"]) {
    assert.ok(reached.has(name), `${name} is not among ${[...reached].join(", ")}`);
  }
  const order = [...reached];
  assert.ok(order.indexOf("align") < 5, `Align is stop ${order.indexOf("align") + 1}: ${order.join(", ")}`);
});

/** Runs in the page: the controls that can be seen and reached by Tab, each with its smaller side in pixels. */
const controlsInSight = `[...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]")]
  .filter((one) => one.tabIndex >= 0 && !one.matches(":disabled") && one.checkVisibility())
  .map((one) => {
    const { width, height } = (one.closest("label") ?? one).getBoundingClientRect();
    return [one.id || one.getAttribute("aria-label") || one.textContent, Math.min(width, height)];
  })`;

const darkPhone = { address: "", ...phone, colorScheme: "dark" } as const;
test("on a phone, dark, axe finds nothing, and all targets are large enough", darkPhone, async (opened, page) => {
  await assertAccessible(opened);
  const measure = async () => {
    const found = (await page.evaluate(controlsInSight)) as [string, number][];
    assert.deepEqual(
      found.filter(([, side]) => side < 43.5),
      [],
    );
  };
  await measure();
  for (const menu of await page.locator("button.menu").all()) {
    await menu.click();
    await page.locator(".menu-box:popover-open").waitFor(PATIENCE);
    await measure();
    assert.deepEqual(await opened.violations(), []);
    await page.keyboard.press("Escape");
  }
});
