/** The package in one piece, where a page may load nothing. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { browserFor, WITHOUT_3D } from "../support/browser.js";
import { installDir } from "../support/environment.js";

const browser = browserFor(installDir, WITHOUT_3D);

test("sim3align/inline works in a sandbox without network access, with workers", { timeout: 120_000 }, async () => {
  const { page } = await browser.open("node_modules/sim3align/package.json");
  const scale = await page.evaluate(async () => {
    const code = await (await fetch("/node_modules/sim3align/inline.js")).text();
    const frame = document.createElement("iframe");
    frame.sandbox.add("allow-scripts");
    const policy = "default-src 'none'; script-src 'unsafe-inline' blob: 'wasm-unsafe-eval'; worker-src blob:";
    frame.srcdoc = `
      <meta http-equiv="Content-Security-Policy" content="${policy}">
      <script type="module">
        const code = ${JSON.stringify(code).replaceAll("</script", "<\\/script")};
        const { createAligner } = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
        const size = 48;
        const depth = new Float32Array(size * size).fill(1.3);
        const mask = new Uint8Array(size * size);
        for (let i = 0; i < depth.length; i++) {
          const [x, y] = [(i % size - 23.5) / 16, (Math.floor(i / size) - 23.5) / 13];
          if (x * x + y * y >= 1) continue;
          mask[i] = 1;
          depth[i] = 1 - 0.2 * (1 - Math.abs(x)) * (1 - Math.abs(y));
        }
        const positions = Float32Array.of(1,0,0, -1,0,0, 0,0.8,0, 0,-0.8,0, 0,0,0.6, 0,0,-0.6);
        const indices = Uint32Array.of(0,2,4, 2,1,4, 1,3,4, 3,0,4, 2,0,5, 1,2,5, 3,1,5, 0,3,5);
        const input = { depth, width: size, height: size, mask, camera: { fovYDeg: 50 }, mesh: { positions, indices } };
        createAligner({ workers: 1 })
          .then((aligner) => aligner.align(input, { quality: "fast" }))
          .then(({ scale }) => parent.postMessage(scale, "*"), (error) => parent.postMessage(String(error), "*"));
      </script>`;
    const answer = new Promise((resolve) => {
      addEventListener("message", ({ data }) => resolve(data), { once: true });
    });
    document.body.append(frame);
    return answer;
  });
  // Half the width of the mask, 16 of 48 pixels at a field of view of 50°, at a distance of a metre.
  assert.ok(typeof scale === "number" && scale > 0.2 && scale < 0.5, String(scale));
});
