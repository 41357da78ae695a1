/** Masks in JSON: every layout gives the pixels of its polygon or run lengths, or names what it holds. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { readMask } from "sim3align/formats";
import { codesOf } from "../support/errors.js";
import { fixture } from "../support/files.js";
import { input, truth, view } from "../support/scene.js";

const { width, height } = { width: 40, height: 30 };
const [left, top, right, bottom] = [8.2, 5.3, 25.4, 20.1];
const box = [left, top, right, top, right, bottom, left, bottom];
const corners = [0, 2, 4, 6].map((i) => box.slice(i, i + 2));
const expected = Uint8Array.from({ length: width * height }, (_, i) => {
  const [x, y] = [(i % width) + 0.5, Math.floor(i / width) + 0.5];
  return x > left && x < right && y > top && y < bottom ? 1 : 0;
});
const labelme = (shapes: object[], more = {}) => ({ shapes, imageHeight: height, imageWidth: width, ...more });
const polygon = { label: "mug", points: corners, shape_type: "polygon", group_id: null };

/** Name, content of the file, and index of the mask in it. */
const layouts: [what: string, json: object, index?: number][] = JSON.parse(
  Buffer.from(fixture("masks.json")).toString("utf8"),
);

test("masks of every layout are the same mask", async () => {
  for (const [what, json, index] of layouts) {
    for (const file of [json, Buffer.from(JSON.stringify(json))]) {
      const read = await readMask(file as object[], { index, width, height });
      const off = read.data.filter((pixel, i) => pixel !== expected[i]).length;
      assert.ok(off <= (what === "LabelMe, a mask" ? 20 : 0), `${what}: ${off} pixels differ`);
      assert.deepEqual(read.unread ?? [], [], what);
    }
  }
});

test("of several masks one has to be chosen; what is not known is named", async () => {
  const several = labelme([polygon, { ...polygon, label: "cup" }]);
  await assert.rejects(
    readMask(several),
    ({ code, found }) => code === "INVALID_ARGUMENT" && /0: label mug.*1: label cup/.test(found),
  );
  await assert.rejects(readMask(several, { index: 2 }), { code: "INVALID_ARGUMENT" });
  await assert.rejects(readMask({ foo: 1 }), { code: "UNSUPPORTED_FORMAT" });
  await assert.rejects(readMask([box]), { code: "UNSUPPORTED_FORMAT" });
  // The rows of a mask are no polygons.
  await assert.rejects(
    readMask([
      [0, 1, 1, 0, 0, 0],
      [0, 1, 1, 0, 0, 0],
    ]),
    { code: "UNSUPPORTED_FORMAT" },
  );
  await assert.rejects(readMask([[0, 0, 900, 0, 900, 900]], { width, height }), { code: "SIZE_MISMATCH" });
  const more = labelme(
    [
      polygon,
      {
        ...polygon,
        shape_type: "point",
        points: [
          [1, 1],
          [1, 1],
        ],
      },
    ],
    { offset: [3, 4] },
  );
  const { unread } = await readMask(more);
  assert.deepEqual(unread, ["the key `offset` of the mask file", "entry 1 of the mask file, which has no area"]);
});

const aligner = await createAligner();

test("a mask of another shape is refused; a square that was padded is cropped", async () => {
  const { width: w, height: h, mask } = view;
  const scaled = (columns: number, rows: number, inside: (u: number, v: number) => number) => ({
    ...{ width: columns, height: rows },
    data: Uint8Array.from({ length: columns * rows }, (_, i) => inside(i % columns, Math.floor(i / columns))),
  });
  const at = (u: number, v: number) => (v < h ? (mask[v * w + u] ?? 0) : 0);
  const evaluated = (other: object, resizeMask?: "nearest") =>
    aligner.evaluate({ ...input, mask: other as never, resizeMask }, truth);
  const padded = await evaluated(
    scaled(2 * w, 2 * w, (u, v) => at(u >> 1, v >> 1)),
    "nearest",
  );
  assert.match(padded.maskReading ?? "", /padded square/);
  assert.deepEqual(padded.metrics, (await evaluated({ data: mask, width: w, height: h })).metrics);
  for (const resize of [undefined, "nearest"] as const) {
    await assert.rejects(
      evaluated(
        scaled(2 * w, h, () => 1),
        resize,
      ),
      { code: "SIZE_MISMATCH", argument: "mask" },
    );
  }
  assert.equal(codesOf(padded.warnings).includes("MASK_HAS_LABELS"), false);
});
