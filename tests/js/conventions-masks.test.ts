/** Masks in other tools' encodings, against what those tools wrote. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { fromCocoRle, fromCvatRle, fromLabelStudioRle, toCocoRle } from "sim3align/conventions";
import { fixtures, pixelsOf } from "../support/conventions.js";
import { type Refused, rejectsWith } from "../support/errors.js";
import { cocoRle } from "../support/files.js";
import { forSeeds } from "../support/random.js";

for (const fixture of fixtures.masks) {
  const { name, width, height } = fixture;
  const mask = { data: pixelsOf(fixture), width, height };

  test(`COCO RLE of ${name} is pycocotools'`, () => {
    assert.deepEqual(toCocoRle(mask), { size: [height, width], counts: fixture.coco });
    assert.deepEqual(toCocoRle(mask, { compressed: false }), { size: [height, width], counts: fixture.cocoRuns });
    assert.deepEqual(fromCocoRle({ size: [height, width], counts: fixture.coco }), mask);
    assert.deepEqual(fromCocoRle({ size: [height, width], counts: fixture.cocoRuns }), mask);
  });

  test(`Label Studio's brush of ${name} is decoded`, () => {
    assert.deepEqual(fromLabelStudioRle(fixture.labelStudio, { width, height }), mask);
    assert.deepEqual(fromLabelStudioRle(Uint8Array.from(fixture.labelStudio), { width, height }), mask);
  });

  test(`CVAT's mask of ${name} is decoded`, () => {
    assert.deepEqual(fromCvatRle(fixture.cvatPoints, { width, height }), mask);
    assert.deepEqual(fromCvatRle(fixture.cvatElement, { width, height }), mask);
  });
}

test("COCO RLE survives, of any mask", () => {
  forSeeds(30, (random, seed) => {
    const [width, height] = [random.whole(1, 40), random.whole(1, 40)];
    const density = random.between(0, 1);
    const data = Uint8Array.from({ length: width * height }, () => (random.between(0, 1) < density ? 1 : 0));
    const mask = { data, width, height };
    assert.deepEqual(fromCocoRle(toCocoRle(mask)), mask, seed);
    assert.deepEqual(toCocoRle(mask, { compressed: false }), cocoRle(data, width, height), seed);
    const bright = { data: Uint8ClampedArray.from(data, (pixel) => 255 * pixel), width, height };
    assert.deepEqual(toCocoRle(bright), toCocoRle(mask), `${seed}: non-zero is the object`);
  });
});

test("long runs take several letters", () => {
  const mask = { data: new Uint8Array(3000 * 2000), width: 3000, height: 2000 };
  mask.data.fill(1, 2_500_000, 2_500_003);
  assert.deepEqual(fromCocoRle(toCocoRle(mask)), mask);
});

const [first] = fixtures.masks;
if (first === undefined) throw new Error("no fixtures");
const size = { width: first.width, height: first.height };
const cut = (list: number[]) => list.slice(0, Math.floor(list.length / 2));

test("broken encodings are refused", async () => {
  const counts = first.coco;
  const coco = (broken: string | number[]) => () => fromCocoRle({ size: [first.height, first.width], counts: broken });
  await rejectsWith(coco(counts.slice(0, -2)), "CORRUPT_FILE rle.counts", /add up to/);
  await rejectsWith(coco(`${counts}é`), "CORRUPT_FILE rle.counts", /character "é"/);
  await rejectsWith(coco(`${counts}P`), "CORRUPT_FILE rle.counts", /unfinished/);
  await rejectsWith(coco("ooooooooo0"), "CORRUPT_FILE rle.counts", /35 bits/);
  await rejectsWith(coco([1.5, 3]), "CORRUPT_FILE rle.counts", /1\.5/);
  await rejectsWith(coco([-1, 3]), "CORRUPT_FILE rle.counts", /-1/);
  await rejectsWith(() => fromCocoRle({ size: [1e9, 1e9], counts: [1e18] }), "FILE_TOO_LARGE rle.size", /8192 × 8192/);
  await rejectsWith(() => fromLabelStudioRle(cut(first.labelStudio), size), "CORRUPT_FILE rle", /truncated/);
  await rejectsWith(() => fromLabelStudioRle([], size), "CORRUPT_FILE rle", /0 bytes/);
  await rejectsWith(() => fromCvatRle([1, 2, ...first.cvatPoints.slice(2)], size), "CORRUPT_FILE mask", /runs of/);
  await rejectsWith(() => fromCvatRle({ ...first.cvatElement, rle: "1, x" }, size), "CORRUPT_FILE mask", /NaN among/);
});

test("encodings of other images are refused", async () => {
  const other = { width: size.width - 30, height: size.height };
  const refused: Refused[] = [
    [() => fromLabelStudioRle(first.labelStudio, other), "SIZE_MISMATCH rle", /original_width/],
    [() => fromCvatRle(first.cvatPoints, other), "SIZE_MISMATCH mask", /within the image/],
    [() => fromCvatRle([1, 2], size), "WRONG_LENGTH mask", /four numbers of the box/],
    [() => fromLabelStudioRle([1, 256], size), "INVALID_ARGUMENT rle", /0 to 255/],
    [() => toCocoRle({ data: new Uint8Array(3), width: 2, height: 2 }), "WRONG_LENGTH mask.data", /2 × 2 = 4/],
    [() => toCocoRle({ data: new Uint8Array(0), width: 0, height: 2 }), "INVALID_ARGUMENT mask.width", /at least 1/],
  ];
  for (const each of refused) await rejectsWith(...each);
});
