import assert from "node:assert/strict";
import { test } from "node:test";
import { columnMajor } from "../support/scene.js";
import { isGreen, isNear, open, openCube, pixelOf, placeOf, withoutWebGpu, withWebGpu } from "../support/view3d.js";

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
