/** Outputs of SAM 3D Objects, dropped as they are. */
import assert from "node:assert/strict";
import { glb } from "../support/files.js";
import { dropFolder, HEIGHT, inFolder, jsonFile, maskPng, seen, WIDTH } from "../support/page-files.js";
import { layoutOf, pointMapNpy } from "../support/sam3d.js";
import { mesh, pinhole, truth } from "../support/scene.js";
import { pageTests } from "../support/site.js";

const test = pageTests();

const view = { depth: seen.depth, width: WIDTH, height: HEIGHT, camera: pinhole };
const output = {
  "pointmap.npy": pointMapNpy(view),
  "0.png": maskPng(seen.mask),
  "0.glb": glb(mesh),
  "0.json": jsonFile(layoutOf({ ...truth, scale: 1.05 * truth.scale })),
};

declare global {
  var sent: string;
}

test("an output opens as a scene without a question, and is aligned without units", async (opened, page) => {
  // What the page asks its workers for.
  await page.evaluate(() => {
    const { postMessage } = Worker.prototype;
    globalThis.sent = "";
    Worker.prototype.postMessage = function (this: Worker, ...message: unknown[]) {
      sent += JSON.stringify(message, (_, value) => (ArrayBuffer.isView(value) ? null : value));
      Reflect.apply(postMessage, this, message);
    };
  });
  await dropFolder(opened, inFolder("desk", output));
  await opened.shows("desk");
  assert.match(await page.evaluate(() => sent), /"initial":\{/, "the placement is a candidate");
  assert.ok((await opened.metric("iou")) > 0.95);
});
