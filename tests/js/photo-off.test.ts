/** Photos that are off the depth map, or blown out in part, agree with the colours of the mesh as those that are not. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { printedBox } from "../support/printed-box.js";

const aligner = await createAligner();
const { mesh, frameAt } = printedBox();
const { frame, image } = frameAt(35);

async function agreementOf(data: Uint8Array): Promise<number> {
  const found = await aligner.align({ ...frame, mesh, image: { ...image, data } }, { quality: "fast" });
  return found.diagnostics.color?.agreement ?? 0;
}

test("a photo that is off the depth map is registered to it", async () => {
  const off = 3;
  const moved = image.data.map((_, i, all) => all[i - 3 * off * (1 + image.width)] ?? 110);
  const [inPlace, registered] = [await agreementOf(image.data), await agreementOf(moved)];
  assert.ok(registered > inPlace - 0.05, `${registered}, in place ${inPlace}`);
});

test("pixels that are blown out do not count", async () => {
  const { width, data } = image;
  const blown = data.map((x, i) => (Math.floor(i / 3) % width < width / 2 ? 255 : x));
  const [whole, part] = [await agreementOf(data), await agreementOf(blown)];
  assert.ok(part > whole - 0.15, `${part}, whole ${whole}`);
});
