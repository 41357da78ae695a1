/** The package and the element in Firefox. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { createAligner } from "sim3align";
import { work } from "../bundlers/work.js";
import { crossOriginHost, servedFolder } from "../support/element-host.js";
import { FirefoxTest, skipFirefox } from "../support/firefox.js";
import { input, mesh } from "../support/scene.js";

const skip = skipFirefox;

let firefox: FirefoxTest;
before(async () => {
  // The package as installed.
  if (!skip) firefox = await FirefoxTest.start(servedFolder);
});
after(() => firefox?.stop());

/** The installed package, below the served folder. */
const installed = "/install-test/node_modules/sim3align";

test("the package has the same bits in Firefox as in Node, in both entries, with and without workers", {
  skip,
}, async () => {
  const expected = await work(createAligner);
  const { page, errors } = await firefox.open(`${installed.slice(1)}/package.json`);
  for (const entry of ["index", "inline"]) {
    const found = (await page.evaluate(`(async () => {
      const { createAligner } = await import("${installed}/${entry}.js");
      const { work } = await import("/install-test/tests/bundlers/work.js");
      return JSON.stringify(await work(createAligner));
    })()`)) as string;
    assert.deepEqual(JSON.parse(found), expected, entry);
  }
  assert.deepEqual(errors, []);
  await page.close();
});

test("the element works in Firefox, also from another origin", { skip }, async (context) => {
  const host = await crossOriginHost();
  context.after(host.close);
  const { page, errors } = await firefox.open(host.path);
  const given = {
    depth: Array.from(input.depth),
    mask: Array.from(input.mask),
    ...{ width: input.width, height: input.height, camera: input.camera },
    ...{ positions: Array.from(mesh.positions), indices: Array.from(mesh.indices) },
  };
  const found = await page.evaluate(async (scene) => {
    const element = document.querySelector("sim3-align") as HTMLElement & { scene: unknown };
    const aligned = new Promise((resolve) =>
      element.addEventListener("align", (event) => resolve((event as CustomEvent).detail.objects[0].pose.matrix)),
    );
    element.scene = {
      ...{ width: scene.width, height: scene.height, camera: scene.camera },
      depth: Float32Array.from(scene.depth),
      objects: [
        {
          mask: Uint8Array.from(scene.mask),
          mesh: { positions: Float32Array.from(scene.positions), indices: Uint32Array.from(scene.indices) },
        },
      ],
    };
    return aligned;
  }, given);
  const { matrix } = await (await createAligner()).align(input);
  assert.deepEqual(found, [...matrix]);
  const area = await page.evaluate(() => {
    const panel = document.querySelector("sim3-align")?.shadowRoot?.querySelector(".result");
    return panel === null || panel === undefined ? 0 : panel.clientWidth * panel.clientHeight;
  });
  assert.ok(area > 20_000, "the sheets of the element apply");
  assert.deepEqual(errors, []);
  await page.close();
});
