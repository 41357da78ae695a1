/** EXIF data, and the focal length that they state. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Exif, focalFromExif, readExif, readImage, Sim3AlignError } from "sim3align/formats";
import { type ExifFields, jpegHead, pngWith, tiff } from "../support/exif.js";
import { png } from "../support/files.js";

const phone: [ExifFields, ExifFields] = [
  { make: "Maker", model: "Phone 1", orientation: 6 },
  { focalLength: { rational: [425, 100] }, focal35: 26, pixelX: 4032, pixelY: 3024, zoom: { rational: [0, 1] } },
];
const reflex: [ExifFields, ExifFields] = [
  { make: "Maker", orientation: 1 },
  {
    focalLength: { rational: [50, 1] },
    planeX: { rational: [6000 * 254, 224] },
    planeUnit: 2,
    pixelX: 6000,
    pixelY: 4000,
    zoom: { rational: [2, 1] },
  },
];

test("EXIF data of PNG and JPEG, in both byte orders", async () => {
  for (const isLittle of [true, false]) {
    for (const file of [pngWith(tiff(...phone, isLittle)), jpegHead(tiff(...phone, isLittle))]) {
      assert.deepEqual(await readExif(file), {
        orientation: 6,
        focalLength35mm: 26,
        focalLengthMm: 4.25,
        make: "Maker",
        model: "Phone 1",
        width: 4032,
        height: 3024,
      });
    }
    const { sensorWidthMm, digitalZoom, ...rest } = await readExif(pngWith(tiff(...reflex, isLittle)));
    assert.ok(Math.abs((sensorWidthMm as number) - 22.4) < 1e-9, `${sensorWidthMm}`);
    assert.equal(digitalZoom, 2);
    assert.deepEqual(rest, { orientation: 1, focalLengthMm: 50, make: "Maker", width: 6000, height: 4000 });
  }
  // The photo is turned by the same orientation.
  const { width, height } = await readImage(pngWith(tiff(...phone, true)));
  assert.deepEqual([width, height], [2, 3]);
  assert.deepEqual(await readExif(png(Uint8Array.of(1), 1, 1)), { orientation: 1 });
});

test("damaged EXIF data: what can be read, or a code", async () => {
  const exif = tiff(...phone, true);
  for (let length = 0; length < exif.length; length++) {
    const { orientation } = await readExif(pngWith(exif.subarray(0, length)));
    assert.ok(orientation === 1 || orientation === 6, `cut to ${length}`);
  }
  const file = pngWith(exif);
  let refused = 0;
  for (let seed = 1; seed < 600; seed++) {
    const damaged = file.slice();
    let state = seed;
    for (let i = 0; i < 3; i++) {
      state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
      damaged[8 + ((state >>> 8) % (damaged.length - 8))] = state >>> 24;
    }
    await readExif(damaged).catch((error) => {
      assert.ok(error instanceof Sim3AlignError && error.code !== "INTERNAL", `seed ${seed}: ${error}`);
      refused += 1;
    });
  }
  assert.ok(refused > 0);
  const jpeg = jpegHead(exif);
  for (let length = 0; length < jpeg.length; length++) {
    const expected = { code: length < 3 ? "UNSUPPORTED_FORMAT" : "CORRUPT_FILE", argument: "image" };
    await assert.rejects(readExif(jpeg.slice(0, length)), expected, `cut to ${length}`);
  }
  await assert.rejects(readExif(Uint8Array.of(1, 2, 3)), { code: "UNSUPPORTED_FORMAT", argument: "image" });
});

const near = (found: number | undefined, expected: number, tolerance: number) =>
  assert.ok(found !== undefined && Math.abs(found / expected - 1) <= tolerance, `${found} instead of ${expected}`);

const full: Exif = { orientation: 1, focalLength35mm: 26, width: 4032, height: 3024 };

test("focal length: the equivalent refers to the diagonal of full frame", () => {
  // 43.267 mm are 5040 pixels.
  const focal = focalFromExif(full, { width: 4032, height: 3024 });
  near(focal?.focalPx, (26 * 5040) / 43.2666, 1e-4);
  assert.ok((focal?.uncertainty ?? 1) > 0.02 && (focal?.uncertainty ?? 1) < 0.04, `${focal?.uncertainty}`);
  assert.match(focal?.source ?? "", /26 mm \(35 mm equivalent\)/);
  // Whole millimetres: half of one is much of 13, little of 77.
  const at = (mm: number, size = { width: 4032, height: 3024 }) =>
    focalFromExif({ ...full, focalLength35mm: mm }, size)?.uncertainty ?? 1;
  assert.ok(at(13) > at(26) && at(26) > at(77));
  assert.equal(focalFromExif({ orientation: 1, width: 40, height: 30 }, { width: 40, height: 30 }), undefined);
  assert.equal(focalFromExif({ ...full, focalLength35mm: 4 }, { width: 4032, height: 3024 }), undefined);
  assert.throws(() => focalFromExif(full, { width: 0, height: 5 }), {
    code: "INVALID_ARGUMENT",
    argument: "size.width",
  });
  assert.throws(() => focalFromExif(null as never, { width: 1, height: 5 }), {
    code: "INVALID_ARGUMENT",
    argument: "exif",
  });
});

test("focal length: the lens on a sensor of known width, and what both sources say", () => {
  const sensor: Exif = { orientation: 1, focalLengthMm: 50, sensorWidthMm: 22.4, width: 6000, height: 4000 };
  const size = { width: 6000, height: 4000 };
  near(focalFromExif(sensor, size)?.focalPx, (50 / 22.4) * 6000, 1e-9);
  // 80 mm is the equivalent; the sensor is known better.
  const both = focalFromExif({ ...sensor, focalLength35mm: 80 }, size);
  near(both?.focalPx, (50 / 22.4) * 6000, 0.01);
  const contradicted = focalFromExif({ ...sensor, focalLength35mm: 50 }, size);
  near(contradicted?.focalPx, (50 / 36) * 6000, 1e-4);
  assert.ok((contradicted?.uncertainty ?? 0) > 0.2);
  // The equivalent counts the digital zoom in; the lens does not.
  const zoomed = focalFromExif({ ...sensor, digitalZoom: 2 }, size);
  near(zoomed?.focalPx, (50 / 22.4) * 12_000, 1e-9);
  assert.ok((zoomed?.uncertainty ?? 0) > 0.2);
  const phone = focalFromExif({ ...full, digitalZoom: 2 }, { width: 4032, height: 3024 });
  near(phone?.focalPx, (26 * 5040) / 43.2666, 1e-4);
});

test("focal length: resized, turned and cropped images", () => {
  const original = (26 * 5040) / 43.2666;
  const sure = focalFromExif(full, { width: 4032, height: 3024 })?.uncertainty as number;
  const focal = (width: number, height: number, exif: Exif = full) => focalFromExif(exif, { width, height });
  near(focal(1008, 756)?.focalPx, original / 4, 1e-4);
  near(focal(1000, 750)?.focalPx, original / 4.032, 1e-3);
  near(focal(8064, 6048)?.focalPx, original * 2, 1e-4);
  assert.ok(Math.abs((focal(1008, 756)?.uncertainty ?? 1) - sure) < 1e-9);
  // To sides that a network likes, multiples of 14: the two scales differ a little.
  near(focal(518, 392)?.focalPx, (original * 518) / 4032, 0.01);
  // Turned: by the orientation, and by a program that left the EXIF sides as they were.
  near(focal(756, 1008, { ...full, orientation: 6 })?.focalPx, original / 4, 1e-4);
  near(focal(756, 1008)?.focalPx, original / 4, 1e-4);
  // Cropped to a square, which keeps the height: the pixels are those of the original.
  const square = focal(3024, 3024);
  near(square?.focalPx, original, 1e-4);
  assert.match(square?.source ?? "", /cropped/);
  assert.ok((square?.uncertainty ?? 0) > sure && (square?.uncertainty ?? 1) < 0.05);
  // Smaller on both sides: perhaps resized as well.
  const part = focal(2400, 2400);
  near(part?.focalPx, original, 1e-4);
  assert.ok((part?.uncertainty ?? 0) > 2 * sure);
  // Too small for a crop alone.
  const small = focal(512, 512);
  near(small?.focalPx, (original * 512) / 3024, 1e-4);
  assert.ok((small?.uncertainty ?? 0) > 0.3);
  // Wider than the original: the EXIF data are those of another image.
  assert.equal(focal(5000, 1000), undefined);
  // Without the original size, the image is taken for the original.
  near(focal(400, 300, { orientation: 1, focalLength35mm: 26 })?.focalPx, (26 * 500) / 43.2666, 1e-4);
});
