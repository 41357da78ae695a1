/** Masks in JSON: every layout gives the pixels of its polygon or run lengths, or names what it holds. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { createAligner } from "sim3align";
import { readMask } from "sim3align/formats";
import { codesOf } from "../support/errors.js";
import { cocoRle, png } from "../support/files.js";
import { input, truth, view } from "../support/scene.js";

const { width, height } = { width: 40, height: 30 };
const [left, top, right, bottom] = [8.2, 5.3, 25.4, 20.1];
const box = [left, top, right, top, right, bottom, left, bottom];
const corners = [0, 2, 4, 6].map((i) => box.slice(i, i + 2));
const expected = Uint8Array.from({ length: width * height }, (_, i) => {
  const [x, y] = [(i % width) + 0.5, Math.floor(i / width) + 0.5];
  return x > left && x < right && y > top && y < bottom ? 1 : 0;
});
const rle = cocoRle(expected, width, height);
const images = [{ id: 7, width, height, file_name: "a.png" }];
const annotation = (id: number, segmentation: unknown = [box]) => ({ id, image_id: 7, category_id: 1, segmentation });
const labelme = (shapes: object[], more = {}) => ({
  shapes,
  imageHeight: height,
  imageWidth: width,
  version: "5",
  ...more,
});
const polygon = { label: "mug", points: corners, shape_type: "polygon", group_id: null };
const png64 = Buffer.from(png(new Uint8Array(18 * 15).fill(1), 18, 15)).toString("base64");

const layouts: [what: string, json: object, index?: number][] = [
  ["COCO RLE", rle],
  ["COCO file", { images, annotations: [annotation(1)], categories: [{ id: 1, name: "mug" }] }],
  ["COCO file, the second", { images, annotations: [annotation(1, [[0, 0, 9, 0, 9, 9]]), annotation(2)] }, 1],
  ["COCO annotation with run lengths", annotation(1, rle)],
  ["SAM's list", [{ segmentation: rle, area: 3, bbox: [0, 0, 1, 1], predicted_iou: 0.9, stability_score: 1 }]],
  ["polygons", [box]],
  ["corners", corners],
  ["LabelMe", labelme([polygon])],
  ["LabelMe, a rectangle", labelme([{ ...polygon, points: [corners[0], corners[2]], shape_type: "rectangle" }])],
  [
    "LabelMe, a mask",
    labelme([
      {
        ...polygon,
        points: [
          [8, 5],
          [25, 19],
        ],
        shape_type: "mask",
        mask: png64,
      },
    ]),
  ],
  [
    "VGG Image Annotator",
    {
      "a.png1": {
        filename: "a.png",
        size: 1,
        file_attributes: {},
        regions: [
          {
            shape_attributes: { name: "rect", x: left, y: top, width: right - left, height: bottom - top },
            region_attributes: {},
          },
        ],
      },
    },
  ],
  [
    "Supervisely",
    {
      size: { height, width },
      tags: [],
      objects: [{ classTitle: "mug", geometryType: "polygon", points: { exterior: corners, interior: [] } }],
    },
  ],
  [
    "Datumaro, a polygon",
    { items: [{ image: { size: [height, width] }, annotations: [{ type: "polygon", points: box }] }] },
  ],
  ["ISAT", { info: { width, height }, objects: [{ category: "mug", segmentation: corners, area: 1 }] }],
];

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
