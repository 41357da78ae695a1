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
    const { Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace, Texture } = await import(
      "/node_modules/three/build/three.module.js"
    );
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
    return ${JSON.stringify(kinds)}.map(([kind, flipY]) => {
      const map = Object.assign(new Texture(images[kind]), { flipY, colorSpace: SRGBColorSpace });
      // The unit square, whose texture coordinates are its own.
      const mesh = new Mesh(new PlaneGeometry(1, 1).translate(0.5, 0.5, 0), new MeshBasicMaterial({ map }));
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
