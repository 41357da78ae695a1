/** Masks in other tools' encodings, against what those tools wrote. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fromRle, toCocoRle } from "sim3align/conventions";
import { fixtures, type MaskFixture, pixelsOf } from "../support/conventions.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { forSeeds } from "../support/random.js";

test("masks of pycocotools, Label Studio and CVAT are read, and written as COCO RLE", () => {
  for (const fixture of fixtures.masks) {
    const { name, width, height, coco, cocoRuns } = fixture;
    const [size, image] = [[height, width] as [number, number], { width, height }];
    const mask = { data: pixelsOf(fixture), ...image };
    assert.deepEqual(toCocoRle(mask), { size, counts: coco }, name);
    assert.deepEqual(toCocoRle(mask, { compressed: false }), { size, counts: cocoRuns }, name);
    for (const counts of [coco, cocoRuns]) assert.deepEqual(fromRle({ size, counts }), mask, name);
    for (const brush of [fixture.labelStudio, Uint8Array.from(fixture.labelStudio)]) {
      assert.deepEqual(fromRle(brush, "label-studio", image), mask, name);
    }
    for (const points of [fixture.cvatPoints, fixture.cvatElement])
      assert.deepEqual(fromRle(points, "cvat", image), mask, name);
  }
});

test("COCO RLE survives, of any mask, with long runs too", () => {
  forSeeds(30, (random, seed) => {
    const [width, height, density] = [random.whole(1, 40), random.whole(1, 40), random.between(0, 1)];
    const data = Uint8Array.from({ length: width * height }, () => (random.between(0, 1) < density ? 1 : 0));
    const mask = { data, width, height };
    assert.deepEqual(fromRle(toCocoRle(mask)), mask, seed);
    const bright = { data: Uint8ClampedArray.from(data, (pixel) => 255 * pixel), width, height };
    assert.deepEqual(toCocoRle(bright), toCocoRle(mask), `${seed}: non-zero is the object`);
  });
  const large = { data: new Uint8Array(3000 * 2000), width: 3000, height: 2000 };
  large.data.fill(1, 2_500_000, 2_500_003);
  assert.deepEqual(fromRle(toCocoRle(large)), large);
});

test("broken encodings, and those of other images, are refused", async () => {
  const first = fixtures.masks[0] as MaskFixture;
  const { width, height, coco, labelStudio, cvatPoints, cvatElement } = first;
  const [size, other] = [
    { width, height },
    { width: width - 30, height },
  ];
  const from = (counts: string | number[]) => () => fromRle({ size: [height, width], counts });
  const refused: Refused[] = [
    [from(coco.slice(0, -2)), "CORRUPT_FILE rle.counts", /add up to/],
    [from(`${coco}é`), "CORRUPT_FILE rle.counts", /character "é"/],
    [from("ooooooooo0"), "CORRUPT_FILE rle.counts", /35 bits/],
    [from([1.5, 3]), "CORRUPT_FILE rle.counts", /1\.5/],
    [() => fromRle({ size: [1e9, 1e9], counts: [1e18] }), "FILE_TOO_LARGE rle.size", /8192 × 8192/],
    [
      () => fromRle(labelStudio.slice(0, labelStudio.length / 2), "label-studio", size),
      "CORRUPT_FILE rle",
      /truncated/,
    ],
    [() => fromRle(labelStudio, "label-studio", other), "SIZE_MISMATCH rle", /original_width/],
    [() => fromRle([1, 2, ...cvatPoints.slice(2)], "cvat", size), "CORRUPT_FILE rle", /runs of/],
    [() => fromRle({ ...cvatElement, rle: "1, x" }, "cvat", size), "CORRUPT_FILE rle", /NaN among/],
    [() => fromRle(cvatPoints, "cvat", other), "SIZE_MISMATCH rle", /within the image/],
    [() => toCocoRle({ data: new Uint8Array(0), width: 0, height: 2 }), "INVALID_ARGUMENT mask.width", /at least 1/],
  ];
  for (const each of refused) await rejectsWith(...each);
});
