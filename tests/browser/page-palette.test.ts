/** The palette: every command of the page with its key, by typing. */
import assert from "node:assert/strict";
import type { Page } from "playwright-core";
import { WEBGL } from "../support/browser.js";
import { depthNpy, dropFolder, files, inFolder, seen } from "../support/page-files.js";
import { PATIENCE, pageTests, type SitePage } from "../support/site.js";

const test = pageTests(WEBGL);

/** A control of the page: its id or accessible name, the choices of a list, and what kind of thing it belongs to. */
interface Control {
  name: string;
  choices: string[];
  kind: string;
}

/** All controls that act, set or choose something, also in menus and behind disclosures, but not what opens these. */
const controlsOf = (page: Page): Promise<Control[]> =>
  page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>("button, input, select")]
      .filter(
        (one) =>
          !one.matches(":disabled, [aria-disabled=true], #commands, .menu, .tip") && one.closest("dialog") === null,
      )
      .filter((one) => !(one instanceof HTMLSelectElement) || one.querySelectorAll("option:enabled").length > 1)
      .map((one) => ({
        name: one.id || one.getAttribute("aria-label") || (one.closest("label") ?? one).textContent?.trim() || "",
        choices: one instanceof HTMLSelectElement ? [...one.options].map(({ text }) => text) : [],
        kind: one.closest(".objects, .scenes, .samples, .alternatives, .exports, .steps")?.className ?? "",
      })),
  );

/** The commands of controls that have other names. */
const named: Readonly<Record<string, string>> = {
  "align-all": "Align all objects",
  align: "Align all objects",
  accept: "Accept the pose",
  fix: "Fix the pose by hand",
  next: "Next object or scene",
  undo: "Undo",
  redo: "Redo",
  refine: "Refine from the current pose",
  Move: "Handles to move",
  Rotate: "Handles to rotate",
  Scale: "Handles to scale",
  snap: "Handles move in steps",
  "local-axes": "Handles along the axes of the mesh",
  "lock-scale": "Lock the scale",
  Edge: "Known size of the object …",
  "known-size": "Known size of the object …",
  "centre-x": "Centre of the object in numbers …",
  "centre-y": "Centre of the object in numbers …",
  "centre-z": "Centre of the object in numbers …",
  "turn-deg": "Turn the object by an angle …",
  Axis: "Turn the object by an angle …",
  Smaller: "Smaller: scale by 2 %",
  Larger: "Larger: scale by 2 %",
  "Lock its pose": "Lock or unlock the pose of the object",
  "Align this object": "Align the selected object",
  Rename: "Rename the object …",
  Remove: "Remove the object",
  Camera: "Camera view",
  "Three-quarter": "Three-quarter view",
  Top: "Top view",
  Side: "Side view",
  Points: "Show or hide the points",
  Mesh: "Show or hide the mesh",
  Sizes: "Show or hide the sizes",
  "Top, side and front": "Top, side and front views, to drag in",
  "point-size": "Size of the points …",
  Before: "Before or after, in 3D",
  measure: "Measure a distance",
  Background: "Photo or depth map",
  "layer-outline": "Show or hide the mask",
  "layer-silhouette": "Show or hide the silhouette",
  "layer-difference": "Depth difference",
  "layer-zoom": "Zoom to the objects",
  wipe: "Wipe between before and after …",
  files: "Open files …",
  folder: "Open a folder …",
  "edit-files": "Change or add files of the scene …",
  forget: "Forget the scene",
  "next-scene": "Next scene",
  "option-scaleMin": "Minimum scale …",
  "option-scaleMax": "Maximum scale …",
  "option-seed": "Seed …",
  "reset-options": "Reset the options to their defaults",
};

/** Lists of which each choice is a command. */
const lists: Readonly<Record<string, string>> = {
  sample: "Sample",
  effort: "Quality",
  "option-up": "Stands upright",
  "option-symmetry": "Symmetry",
};

/** What the palette has to list for a control. */
function commandsFor({ name, choices, kind }: Control): string[] {
  const list = lists[name];
  // A scene that is no sample is chosen from the list of samples, but not by it.
  if (list !== undefined) return choices.filter((one) => one !== "Own files").map((one) => `${list}: ${one}`);
  if (kind === "exports") return [`Export: ${name}`];
  if (kind === "samples") return [`Sample: ${name}`];
  if (kind === "scenes") return [`Scene: ${name.split(" ")[0]}`];
  if (kind === "objects" && name.startsWith("Show ")) return ["Show or hide the object"];
  if (kind === "objects" && named[name] === undefined) return [`Object: ${/^[A-Z][a-z]+/.exec(name)?.[0]}`];
  if (kind === "alternatives") return [name === "Best" ? "Pose: the result" : `Pose: alternative at ${name}`];
  return [named[name] ?? name];
}

/** That the palette lists what every control of the page does. */
async function listsAll(opened: SitePage, least: number): Promise<void> {
  const controls = await controlsOf(opened.page);
  assert.ok(controls.length >= least, `${controls.length} controls`);
  const listed = await opened.commands();
  assert.equal(new Set(listed).size, listed.length, "a command is listed twice");
  const missing = controls.flatMap(commandsFor).filter((one) => !listed.includes(one));
  assert.deepEqual(missing, []);
}

test("the palette lists what every control does: of several objects", "", async (opened, page) => {
  await opened.has3d("webgl");
  await page.keyboard.press("n");
  await opened.press("Move left");
  await opened.press("Move right");
  await page.click("#undo");
  await listsAll(opened, 70);
});

test("the palette lists what every control does: of several scenes, with alternatives", async (opened, page) => {
  await opened.choose("#option-symmetry", "none");
  const other = { ...files, "depth.npy": depthNpy(seen.depth.map((z) => z + 0.01)) };
  await dropFolder(opened, { ...inFolder("IMG_001", files), ...inFolder("IMG_002", other) });
  await opened.sheet();
  await page.click("#intake-open");
  await opened.shows("IMG_001");
  await opened.has3d("webgl");
  await listsAll(opened, 60);
  const listed = await opened.commands();
  for (const one of ["Export: JSON of all scenes", "Scene: IMG_002", "Forget the scene"])
    assert.ok(listed.includes(one), one);
  // What can do nothing is not listed.
  for (const one of ["Next frame", "Remove the object", "Export: JSON of all frames"])
    assert.ok(!listed.includes(one), one);
});

test("keys are shown beside their commands", async (opened, page) => {
  await page.keyboard.press("Control+k");
  await page.locator(".palette[open]").waitFor(PATIENCE);
  const texts = await page.locator(".palette [role=option]").allTextContents();
  for (const text of ["UndoCtrlZ", "Align all objectsShiftA", "Help?", "Pose: the result0"])
    assert.ok(texts.includes(text), `${text} is not in ${texts.join(", ")}`);
  assert.deepEqual(opened.errors, []);
});

test("the palette finds commands by typing, and runs them", async (opened, page) => {
  await page.keyboard.press("Control+k");
  const field = page.getByRole("combobox", { name: "Find a command" });
  await field.waitFor(PATIENCE);
  assert.deepEqual(await opened.violations(), []);
  const options = page.locator(".palette [role=option]");
  await field.fill("view CAMERA");
  assert.deepEqual(await options.allTextContents(), ["Camera viewC"]);
  await field.fill("show or hide");
  assert.ok((await options.count()) > 3);
  const chosen = () => page.locator(".palette [aria-selected=true]").textContent();
  const first = await chosen();
  await page.keyboard.press("ArrowDown");
  assert.notEqual(await chosen(), first);
  assert.equal(
    await field.getAttribute("aria-activedescendant"),
    await page.locator(".palette [aria-selected=true]").getAttribute("id"),
  );
  await field.fill("no such command");
  assert.equal(await options.count(), 0);
  await page.keyboard.press("Enter");
  await field.fill("depth difference");
  await page.keyboard.press("Enter");
  await page.locator(".palette").waitFor({ state: "hidden", ...PATIENCE });
  await page.locator(".legend-bar").first().waitFor(PATIENCE);
  // What is to be entered is shown with the focus on it. The key works in a text field, too; and so does the mouse.
  await page.keyboard.press("Control+k");
  await field.fill("known size");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement?.id), "known-size");
  await page.keyboard.press("Control+k");
  await field.fill("size points");
  await page.keyboard.press("Enter");
  await page.locator(".menu-box:popover-open #point-size:focus").waitFor(PATIENCE);
  await page.keyboard.press("Escape");
  await page.keyboard.press("Control+k");
  await field.fill("rename");
  await page.keyboard.press("Enter");
  await page.locator(".rename:focus").waitFor(PATIENCE);
  await page.keyboard.type("Cup");
  await page.keyboard.press("Control+k");
  await field.fill("theme dark");
  await options.click();
  await page.waitForFunction(() => document.documentElement.style.colorScheme === "dark");
  assert.match((await page.textContent("#result-title")) ?? "", /Cup/);
  await page.click("#commands");
  await field.waitFor(PATIENCE);
  await page.keyboard.press("Control+k");
  await page.locator(".palette").waitFor({ state: "hidden", ...PATIENCE });
});
