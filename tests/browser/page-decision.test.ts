/** The decision about results: accept, fix, next; what helps when unsure; the objects of a scene. */
import assert from "node:assert/strict";
import { SOFTWARE } from "../support/browser.js";
import { choose, drop, files } from "../support/page-files.js";
import { PATIENCE, pageTests } from "../support/site.js";

const test = pageTests();

test("accepting goes on to the next object", "#sample=desk", async (opened, page) => {
  const chosen = async () => (await page.textContent(".objects [aria-pressed=true] .name")) ?? "";
  const seen: string[] = [];
  for (let i = 0; i < 3; i++) {
    seen.push(await chosen());
    await page.click("#accept");
  }
  assert.equal(new Set(seen).size, 3);
  await opened.says(/All objects are accepted/);
  assert.equal(await page.locator(".objects .confidence", { hasText: "✓" }).count(), 3);
  await page.locator(".objects .select").first().click();
  assert.match((await page.textContent("#accept")) ?? "", /Accepted/);
});

const hammer = "#sample=hammer&quality=fast";
test("a wrong mesh is named, and a known size is tried at once", hammer, async (opened, page) => {
  // The mesh of another object: nothing fits.
  await opened.click("#edit-files");
  const sheet = await opened.sheet();
  await choose(opened, "mesh", "other.obj", files["mesh.obj"] as Uint8Array);
  await opened.sheet();
  await sheet.locator("#intake-open").click();
  await opened.shows("Own files");
  await page.locator(".remedies").waitFor(PATIENCE);
  // The cause is named first, and the files are one click away.
  assert.equal(await page.getAttribute(".advice", "data-cause"), "mesh");
  assert.deepEqual(await opened.violations(), []);
  await page.locator(".advice button", { hasText: "Change the files" }).click();
  await opened.sheet();
  await page.click("#intake-cancel");
  await page.fill("#remedy-size", "20");
  await page.press("#remedy-size", "Enter");
  await page.locator(".remedies .trial").getByRole("button", { name: "Use", exact: true }).click(PATIENCE);
  assert.equal(Math.max(...(await opened.dimensions())), 20);
  assert.ok(await page.isChecked("#lock-scale"));
});

test("objects are hidden, locked, renamed and removed", "#sample=desk", async (opened, page) => {
  const rows = page.locator(".objects li");
  // The selected object has a menu.
  await page.locator(".objects .select", { hasText: "Teapot" }).click();
  const before = await opened.imagePixels();
  const show = async (isShown: boolean) => {
    await page.getByRole("button", { name: "More for Teapot" }).click();
    await page.getByLabel("Show Teapot").setChecked(isShown);
    assert.deepEqual(await opened.violations(), []);
    await page.keyboard.press("Escape");
  };
  await show(false);
  assert.ok(await rows.filter({ hasText: "Teapot" }).getByRole("img", { name: "hidden" }).isVisible());
  const hidden = await opened.imagePixels();
  assert.notDeepEqual(hidden.data, before.data);
  await show(true);
  assert.deepEqual((await opened.imagePixels()).data, before.data);

  // The first click selects, which changes the result, but does not move the row.
  await page.locator(".objects .select", { hasText: "Box" }).dblclick();
  await page.keyboard.type("Tea box");
  await page.keyboard.press("Enter");
  assert.equal(await rows.nth(0).locator(".name").textContent(), "Tea box");
  assert.deepEqual(await page.locator(".objects .rename").count(), 0);
  const { name, bytes } = await opened.saved("JSON");
  assert.equal(name, "desk.json");
  assert.ok("Tea box" in (JSON.parse(`${bytes}`) as object));

  // A locked pose stays where a person has put it.
  await page.click(".hand-panel .more summary");
  await opened.press("Move left");
  await opened.isNow("hand");
  const moved = await page.textContent("#centre");
  await page.getByRole("button", { name: "More for Tea box" }).click();
  await page.getByLabel("Lock its pose").check();
  assert.ok(await page.getByRole("button", { name: "Align this object" }).isDisabled());
  await page.keyboard.press("Escape");
  await page.click("#align-all");
  await opened.says(/^Aligned 2 objects/);
  assert.equal(await page.textContent("#centre"), moved);
  assert.equal(await opened.source(), "hand");

  await page.locator(".objects .select", { hasText: "Animal" }).click();
  await page.getByRole("button", { name: "More for Animal" }).click();
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  assert.equal(await rows.count(), 2);
  await page.locator(".objects .select", { hasText: "Tea box" }).click();
  assert.equal(await page.textContent("#centre"), moved);
  assert.ok(!page.url().includes("sample="), "a link to another scene");
});

test("what an object stands on is said, and the scene is saved as one GLB", "#sample=table", async (opened, page) => {
  await page.click("#align-all");
  await page.locator(".contact", { hasText: /^Stands on the ground/ }).waitFor(PATIENCE);
  const masks = JSON.parse(`${(await opened.saved("COCO JSON")).bytes}`) as { annotations: { area: number }[] };
  assert.equal(masks.annotations.filter(({ area }) => area > 0).length, 3);
  const { bytes: bodies } = await opened.saved("MJCF");
  assert.match(`${bodies}`, /scene\.xml/);
  const { name, bytes } = await opened.saved("GLB of the scene");
  assert.equal(name, "scene.glb");
  const length = bytes.readUInt32LE(12);
  const { nodes } = JSON.parse(bytes.subarray(20, 20 + length).toString()) as { nodes: { name?: string }[] };
  for (const object of ["Teapot", "Mug", "Box"])
    assert.ok(
      nodes.some((node) => node.name === object),
      object,
    );
});

test(
  "decided poses stay when all are aligned, and are saved with their comments",
  "#sample=desk",
  async (opened, page) => {
    await page.click("#accept");
    await page.keyboard.press("x");
    await opened.says(/^Skipped/);
    await page.click("#align-all");
    await opened.says(/^Aligned in .* 2 decided, chosen or locked poses are left unchanged/);
    await page.locator(".objects .select").first().click();
    assert.equal(await page.textContent("#accept"), "✓ Accepted");
    await opened.enter("#comment", "lid open");
    const { _about, ...saved } = JSON.parse(`${(await opened.saved("JSON")).bytes}`) as Record<string, object>;
    const decisions = Object.values(saved).map((one) => (one as { decision: string | null }).decision);
    assert.deepEqual(decisions, ["accepted", "skipped", null]);
    assert.equal((Object.values(saved)[0] as { comment: string }).comment, "lid open");
  },
);

test(
  "a corrected mask concerns its object only, and one step takes all of it back",
  "#sample=desk",
  async (opened, page) => {
    const rows = () => page.locator(".objects .select").allTextContents();
    const state = async () => [
      await rows(),
      await page.textContent("#result-title"),
      await page.textContent("#centre"),
    ];
    await page.click("#accept");
    await page.click("#accept");
    const before = await state();
    await page.click("#correct-mask");
    await page.locator("#mask-edges").uncheck(PATIENCE);
    await page.locator("#mask-size").press("End");
    await page.click("#mask-here");
    await page.click("#mask-done");
    await opened.shows("Own files");
    const after = await state();
    assert.deepEqual([(after[0] as string[]).slice(0, 2), after[1]], [(before[0] as string[]).slice(0, 2), before[1]]);
    assert.notEqual(after[2], before[2]);
    await page.keyboard.press("Control+z");
    assert.deepEqual(await state(), before);
    await page.keyboard.press("Control+Shift+z");
    assert.deepEqual(await state(), after);
  },
);

test("a mask is corrected beside the result, or left as it is", async (opened, page) => {
  await drop(opened, files);
  await opened.shows("Own files");
  const before = await page.textContent("#centre");
  await page.click("#correct-mask");
  await page.locator(".mask-editor").waitFor(PATIENCE);
  await page.click("#mask-cancel");
  await page
    .locator("dialog[open]")
    .first()
    .waitFor({ state: "detached", ...PATIENCE });
  assert.equal(await page.textContent("#centre"), before);
  await page.click("#correct-mask");
  await page.click("#mask-here", PATIENCE);
  await page.locator("#mask-status[aria-busy=false]").filter({ hasText: "is marked" }).waitFor(PATIENCE);
  await page.click("#mask-done");
  // It is aligned anew without another question.
  await page
    .locator("dialog[open]")
    .first()
    .waitFor({ state: "detached", ...PATIENCE });
  await opened.shows("Own files");
});

const phone = { viewport: { width: 390, height: 844 }, address: "#sample=mug" };
pageTests(SOFTWARE)("on a phone, the handles are below the 3D view that has them", phone, async (_opened, page) => {
  await page.locator('.space[data-state="ready"]').waitFor(PATIENCE);
  await page.click("#fix");
  const ends = async (part: string) => {
    const { y = 0, height = 0 } = (await page.locator(part).boundingBox()) ?? {};
    return [Math.round(y), Math.round(y + height)] as const;
  };
  await page.locator(".handles button:focus").waitFor(PATIENCE);
  const [view, handles, bar] = [await ends(".space .view-host"), await ends(".handles"), await ends(".run")];
  assert.ok(view[0] >= 0 && view[1] <= handles[0] && handles[1] <= bar[0], `${view}; ${handles}; ${bar}`);
});
