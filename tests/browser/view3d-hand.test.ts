import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import {
  host,
  isNear,
  openCube,
  type Place,
  pixelOf,
  placeOf,
  pose,
  type ViewEvent,
  withoutWebGpu,
} from "../support/view3d.js";

const browser = withoutWebGpu();

/** Drags a handle and returns the pose events. */
async function drag(page: Page, from: Place, by: Place): Promise<Extract<ViewEvent, { kind: "pose" }>[]> {
  await page.mouse.move(...from);
  await page.mouse.down();
  for (const share of [0.3, 0.7, 1]) await page.mouse.move(from[0] + share * by[0], from[1] + share * by[1]);
  await page.mouse.up();
  const told = (await page.evaluate(() => harness.viewEvents.splice(0))) as ViewEvent[];
  return told.filter((one) => one.kind === "pose");
}

test("the gizmo moves, rotates and scales about the mesh centre, and reports the pose", async () => {
  const { page, errors, facts } = await openCube(browser);
  const [x, y] = placeOf(facts, ...pixelOf(facts, 0, 0, 0.8));
  await page.evaluate(() => harness.view.select("cube"));
  const scalePx = Math.min(host.width / facts.width, host.height / facts.height);
  const reset = () => page.evaluate((pose) => harness.view.setPose("cube", pose), pose(0, 0));
  const gizmo = async (mode: string) => {
    await reset();
    await page.evaluate((mode) => harness.view.setGizmo(mode), mode);
    await page.evaluate(() => harness.colours([]));
  };
  const centreOf = (m: readonly number[]) => [0, 1, 2].map((k) => 3 * (m[k] ?? 0) + (m[12 + k] ?? 0));
  // Positions of the handles of three.js: arrows to the right, the outermost ring.
  const half = (scalePx * facts.height) / 2;
  const unit = (1.9 * 0.9 * half) / 4;

  await gizmo("translate");
  const moves = await drag(page, [x + 0.4 * unit, y], [60, 0]);
  const moved = moves.at(-1);
  assert.ok(
    moved && moves.length > 1 && moves.slice(0, -1).every(({ phase }) => phase === "drag"),
    "no events during the drag",
  );
  assert.equal(moved.phase, "end");
  const expectedM = ((60 / scalePx) * 0.8) / facts.camera.fx;
  isNear(centreOf(moved.pose), [expectedM, 0, 0.8], 0.004);
  isNear(moved.pose.slice(0, 12), pose(0, 0).slice(0, 12), 1e-9);

  await gizmo("scale");
  const grown = (await drag(page, [x + 0.4 * unit, y], [40, 0])).at(-1);
  assert.ok(grown && (grown.pose[0] ?? 0) > 0.105, `${grown?.pose}`);
  isNear([grown.pose[5] ?? 0, grown.pose[10] ?? 0], [grown.pose[0] ?? 0, grown.pose[0] ?? 0], 1e-9);
  isNear(centreOf(grown.pose), [0, 0, 0.8], 1e-6);

  await gizmo("rotate");
  const ring = (0.75 * unit) / Math.SQRT2;
  const turned = (await drag(page, [x + ring, y - ring], [0, 2 * ring])).at(-1);
  assert.ok(turned, "no pose");
  const angleDeg = (Math.atan2(turned.pose[1] ?? 0, turned.pose[0] ?? 0) * 180) / Math.PI;
  assert.ok(Math.abs(angleDeg - 90) < 8, `turned by ${angleDeg}, clockwise`);
  isNear(centreOf(turned.pose), [0, 0, 0.8], 1e-6);
  assert.deepEqual(errors, []);
});

test("clicks on meshes and points select objects, and hovering reports the pixel of the depth map", async () => {
  const { page, errors, facts } = await openCube(browser);
  const told = async () => (await page.evaluate(() => harness.viewEvents.splice(0))) as ViewEvent[];
  const selectedAt = async (u: number, v: number) => {
    await page.mouse.click(...placeOf(facts, u, v));
    return (await told()).filter(({ kind }) => kind === "select");
  };
  assert.deepEqual(await selectedAt(...pixelOf(facts, 0.01, 0.01, 0.75)), [{ kind: "select", id: "cube" }]);
  assert.deepEqual(await selectedAt(10, 10), [{ kind: "select", id: null }]);
  assert.deepEqual(await selectedAt(122, 92), [{ kind: "select", id: "cube" }]);
  await told();
  await page.mouse.move(...placeOf(facts, 20, 100));
  await page.waitForFunction(() => harness.viewEvents.some(({ kind }) => kind === "hover"));
  const hover = (await told()).filter((one) => one.kind === "hover").at(-1);
  assert.ok(
    hover?.pixel && Math.abs(hover.pixel.x - 20) <= 3 && Math.abs(hover.pixel.y - 100) <= 3,
    JSON.stringify(hover),
  );
  await page.mouse.move(2, 150);
  await page.waitForFunction(() => harness.viewEvents.some((one) => one.kind === "hover" && one.pixel === null));
  assert.deepEqual(errors, []);
});
