import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { glbFrom, meshoptGltf } from "../support/compressed.js";
import { columnMajor } from "../support/scene.js";
import {
  host,
  isGreen,
  isNear,
  open,
  openCube,
  type Place,
  pixelOf,
  placeOf,
  pose,
  type ViewEvent,
  withoutWebGpu,
  withWebGpu,
} from "../support/view3d.js";

const [webGpu, webGl] = [withWebGpu(), withoutWebGpu()];

const modes = [
  ["WebGPU", webGpu, false, "webgpu"],
  ["WebGL, forced", webGpu, true, "webgl"],
  ["WebGL, without WebGPU", webGl, false, "webgl"],
] as const;

for (const [name, browser, isForced, expected] of modes) {
  test(`${name}: points and mesh are drawn where the depth camera sees them`, async () => {
    const { page, errors, facts, backend, colours } = await openCube(browser, isForced);
    assert.equal(backend, expected);
    const at = (u: number, v: number) => placeOf(facts, u, v);
    const points = await colours([at(10, 10), at(78, 30), at(82, 30), at(10, 110), at(150, 110), [3, 150], [497, 150]]);
    const [first, left, right, third, fourth, ...bars] = points;
    const [red, blue, yellow, grey] = facts.quarters;
    isNear(first, red ?? []);
    isNear(left, red ?? []);
    isNear(right, blue ?? []);
    isNear(third, yellow ?? []);
    isNear(fourth, grey ?? []);
    for (const bar of bars) isNear(bar, [250, 251, 252]);

    // Points of the mask next to the cube are tinted, and those outside the mask are not.
    const [masked, beside] = await colours([at(120, 90), at(120, 104)]);
    assert.ok((masked?.[1] ?? 0) > (masked?.[0] ?? 0) + 20, `${masked}`);
    isNear(beside, grey ?? []);

    // The cube's front is at 0.75 m, 0.1 m wide: just inside and just outside of its edges.
    const inside = [-0.046, 0.046].flatMap((x) => [-0.045, 0.045].map((y) => pixelOf(facts, x, y, 0.75)));
    const outside = [-0.055, 0.055].flatMap((x) => [pixelOf(facts, x, 0, 0.75), pixelOf(facts, 0, x, 0.75)]);
    for (const colour of await colours(inside.map(([u, v]) => at(u, v)))) assert.ok(isGreen(colour), `${colour}`);
    for (const colour of await colours(outside.map(([u, v]) => at(u, v)))) assert.ok(!isGreen(colour), `${colour}`);

    const [u, v] = pixelOf(facts, 0, 0, 0.75);
    await page.evaluate(() => harness.show({ hidden: ["cube"] }));
    assert.ok(!isGreen((await colours([at(u, v)]))[0]), "a hidden mesh");
    assert.deepEqual(errors, []);
  });
}

test("a new scene knows no pose of the one before, though its objects have the same ids", async () => {
  const { page, facts, colours } = await openCube(webGl);
  const place = [placeOf(facts, ...pixelOf(facts, 0, 0, 0.75))];
  assert.ok(isGreen((await colours(place))[0]));
  await page.evaluate(async () => {
    harness.show();
    await harness.view.setObjects([harness.object("cube", "#00c040")]);
  });
  assert.ok(!isGreen((await colours(place))[0]));
});

test("glTF node transforms are applied, and an invalid GLB leaves the view unchanged", async () => {
  const { page, errors, facts, colours } = await openCube(webGl, false, "glb");
  const [u, v] = pixelOf(facts, 0, 0, 0.75);
  const [beside] = [pixelOf(facts, 0.056, 0, 0.75)];
  const places = [placeOf(facts, u, v), placeOf(facts, ...beside)];
  const check = async () => {
    const [inside, outside] = await colours(places);
    assert.ok(isGreen(inside) && !isGreen(outside), `${inside}; ${outside}`);
  };
  await check();
  const said = await page.evaluate(() =>
    harness.view.setObjects([harness.object("cube", "#ff0000", "broken")]).then(
      () => "nothing",
      (error: Error) => error.name,
    ),
  );
  assert.match(said, /Error/);
  await check();
  assert.deepEqual(errors, []);
});

test("a mesh that meshopt compressed and quantised is drawn as its file has it", async () => {
  const ends = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [2.5 + (i & 1), ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5]);
  const sides = [
    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
  ];
  const cube = { positions: Float32Array.from(ends), indices: Uint32Array.from(sides) };
  const glb = glbFrom(meshoptGltf(cube, "EXT_meshopt_compression", true));
  const { errors, facts, colours } = await openCube(webGl, false, [...glb]);
  const at = (x: number) => placeOf(facts, ...pixelOf(facts, x, 0, 0.75));
  const [inside, outside] = await colours([at(0), at(0.056)]);
  assert.ok(isGreen(inside) && !isGreen(outside), `${inside}; ${outside}`);
  assert.deepEqual(errors, []);
});

test("views from above and from the side follow the ground", async () => {
  const { page, colours } = await openCube(webGl);
  // Turned about the camera's x axis, together with what stands on it.
  const lean = (35 * Math.PI) / 180;
  await page.evaluate(
    ([pose, normal]) => {
      harness.view.setGround({ normal: normal as [number, number, number], d: 0.6 });
      return harness.view.setPose("cube", pose as number[]);
    },
    [
      columnMajor({
        ...{ scale: 0.1, rotation: [Math.sin(-lean / 2), 0, 0, Math.cos(lean / 2)] },
        translation: [-0.3, 0, 0.8],
      }),
      [0, -Math.cos(lean), Math.sin(lean)],
    ] as const,
  );
  const corners: [number, number][] = [-55, 55].flatMap((x) =>
    [-55, 55].map((y) => [250 + x, 150 + y] as [number, number]),
  );
  for (const look of ["top", "side"]) {
    await page.evaluate((look) => harness.view.lookFrom(look), look);
    const found = await colours(corners);
    // The cube is a square with level sides: in any other turn, its corners are elsewhere.
    assert.ok(found.every(isGreen), `${look}: ${found.join("; ")}`);
  }
});

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
  const { page, errors, facts } = await openCube(webGl);
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
  const { page, errors, facts } = await openCube(webGl);
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

test("a lost WebGL 2 device is replaced once; a second loss shows a message", async () => {
  const { page, errors, facts, colours } = await openCube(webGl);
  const lose = () =>
    page.evaluate(() => {
      const canvas = document.querySelector("#host canvas") as HTMLCanvasElement;
      canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
      canvas.id = "old";
    });
  await lose();
  await page.waitForSelector("#host canvas:not(#old)");
  const [cube, wall] = await colours([placeOf(facts, ...pixelOf(facts, 0, 0, 0.75)), placeOf(facts, 10, 10)]);
  assert.ok(isGreen(cube), `${cube}`);
  isNear(wall, facts.quarters[0] ?? []);
  await lose();
  await page.waitForSelector('#host [role="alert"]');
  assert.deepEqual(errors, []);
});

test("without WebGPU and WebGL 2, creating a view rejects with NoGraphics and leaves no elements", async () => {
  const { page, errors } = await open(webGl);
  const said = await page.evaluate(() => {
    HTMLCanvasElement.prototype.getContext = () => null;
    return harness.start(100, 100).then(
      () => "a view",
      (error: Error) => error.name,
    );
  });
  assert.equal(said, "NoGraphics");
  assert.equal(await page.locator("#host *").count(), 0);
  assert.deepEqual(errors, []);
});
