/** Textures of three.js in a browser: images and bitmaps are read by way of a canvas. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { browserFor, WITHOUT_3D } from "../support/browser.js";
import { installDir } from "../support/environment.js";

const browser = browserFor(installDir, WITHOUT_3D);

/** The kinds of images, and whether three.js turns them over when it uploads them. */
const kinds = [
  ["image", false],
  ["image", true],
  ["bitmap", false],
  ["bitmap", true],
  ["canvas", true],
] as const;

test("the colours of images, bitmaps and canvases are seen where three.js shows them", async () => {
  const { page } = await browser.open("node_modules/sim3align/package.json");
  const found = (await page.evaluate(`(async () => {
    const { meshInputFromThree } = await import("/node_modules/sim3align/three.js");
    const canvas = new OffscreenCanvas(2, 2);
    const context = canvas.getContext("2d");
    ["#c82820", "#28aa3c", "#1e3cbe", "#dcc828"].forEach((color, i) => {
      context.fillStyle = color;
      context.fillRect(i % 2, i >> 1, 1, 1);
    });
    const blob = await canvas.convertToBlob();
    const image = new Image();
    image.src = URL.createObjectURL(blob);
    await image.decode();
    const images = { image, bitmap: await createImageBitmap(blob), canvas };
    const attribute = (size, numbers) => ({
      count: numbers.length / size,
      getX: (i) => numbers[size * i],
      getY: (i) => numbers[size * i + 1],
      getZ: (i) => numbers[size * i + 2],
    });
    // The unit square, whose texture coordinates are its own.
    const position = attribute(3, [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0]);
    const uv = attribute(2, [0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1]);
    const elements = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    return ${JSON.stringify(kinds)}.map(([kind, flipY]) => {
      const mesh = {
        isMesh: true,
        geometry: { attributes: { position, uv }, index: null },
        material: { map: { image: images[kind], flipY, colorSpace: "srgb" } },
        matrixWorld: { elements },
        updateWorldMatrix() {},
        traverse(visit) { visit(this); },
      };
      const { samples } = meshInputFromThree(mesh);
      // The first sample of each quarter, that of x = y = 0 first, then by x.
      const quarters = [];
      for (let i = 0; i < samples.positions.length / 3; i++) {
        const [x, y] = samples.positions.subarray(3 * i);
        quarters[(x > 0.5) + 2 * (y > 0.5)] ??= [...samples.colors.subarray(3 * i, 3 * i + 3)];
      }
      return quarters;
    });
  })()`)) as number[][][];
  const [red, green, blue, yellow] = [
    [200, 40, 32],
    [40, 170, 60],
    [30, 60, 190],
    [220, 200, 40],
  ] as const;
  const asStored = [red, green, blue, yellow];
  const turnedOver = [blue, yellow, red, green];
  // Graphics cards upload bitmaps as they are.
  assert.deepEqual(found, [asStored, turnedOver, asStored, asStored, turnedOver]);
});
