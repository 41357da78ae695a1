/** The picture of the README: what goes in, and what comes out. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { at, packageDir } from "../lib/paths.mjs";
import { serve } from "../lib/static-server.mjs";
import { kitchenDir, kitchenObjects } from "./kitchen.mjs";

/** @typedef {import("playwright-core").Browser} Browser */

/** Draws meshes, each as large as the next, and a depth map with masks; three.js and the files are on the same server. */
const drawing = `
import { AmbientLight, Box3, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
const renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
renderer.setSize(300, 300);
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
for (const [image, address, up] of inputs.meshes) {
  const { scene } = await loader.loadAsync(address);
  const all = new Scene().add(scene, new AmbientLight(0xffffff, 1.8));
  const light = new DirectionalLight(0xffffff, 2.2);
  const camera = new PerspectiveCamera(30, 1, 0.1, 20);
  camera.up.set(...up);
  const box = new Box3().setFromObject(scene);
  const middle = box.getCenter(new Vector3());
  const away = up[2] === 1 ? new Vector3(-1.2, -1.6, 0.9) : new Vector3(1.2, 0.9, 1.6);
  camera.position.copy(middle).addScaledVector(away.normalize(), 3 * box.getSize(new Vector3()).length() / 1.55);
  light.position.copy(camera.position).addScaledVector(camera.up, 3);
  camera.lookAt(middle);
  renderer.render(all.add(light), camera);
  document.getElementById(image).src = renderer.domElement.toDataURL();
}
document.body.dataset.state = "done";
`;

/** Depth in greys from near to far, with masks in colours, as an image of bytes. */
async function observation() {
  const { readDepth, readMask } = await import(pathToFileURL(join(packageDir, "formats.js")).href);
  const { data, width, height } = await readDepth(readFileSync(join(kitchenDir, "depth.png")), { depthScale: 0.001 });
  const colours = [
    [255, 190, 40],
    [60, 150, 255],
    [60, 200, 130],
  ];
  const masks = await Promise.all(
    kitchenObjects.map(
      async (name) => (await readMask(readFileSync(join(kitchenDir, "objects", name, "mask.png")))).data,
    ),
  );
  const [near, far] = [0.38, 1.05];
  const pixels = Array.from(data, (/** @type {number} */ depth, /** @type {number} */ i) => {
    const grey = 235 - 205 * Math.min(1, Math.max(0, (depth - near) / (far - near)));
    const colour = colours[masks.findIndex((mask) => mask[i] !== 0)];
    return [0, 1, 2].map((k) => Math.round(colour === undefined ? grey : 0.45 * grey + 0.55 * (colour[k] ?? 0)));
  });
  return { width, height, pixels: pixels.flatMap((rgb) => [...rgb, 255]) };
}

const page = (/** @type {string} */ placed, /** @type {object} */ inputs) => `<!doctype html>
<script type="importmap">{ "imports": { "three": "/node_modules/three/build/three.module.js", "three/addons/": "/node_modules/three/examples/jsm/" } }</script>
<style>
  body { margin: 0; width: 1200px; display: grid; grid-template: 1fr 1fr / 268px 228px 1fr; gap: 10px; background: #fff;
    font: 15px system-ui, sans-serif; color: #1a1f27; }
  figure { margin: 0; display: flex; flex-direction: column; gap: 4px; }
  figcaption { text-align: center; }
  img, canvas { width: 100%; flex: 1; min-height: 0; object-fit: cover; border-radius: 8px; }
  .meshes { grid-row: 1 / 3; grid-column: 2; }
  .meshes div { flex: 1; display: flex; flex-direction: column; justify-content: space-around; background: #e9ecf1; border-radius: 8px; }
  .meshes img { flex: 0 0 auto; height: 138px; object-fit: contain; }
  .placed { grid-row: 1 / 3; grid-column: 3; }
</style>
<figure><img src="/www/samples/kitchen/rgb.webp"><figcaption>a photo</figcaption></figure>
<figure class="meshes"><div>${kitchenObjects.map((name) => `<img id="${name}">`).join("")}</div><figcaption>generated meshes, of no size</figcaption></figure>
<figure class="placed"><img src="${placed}"><figcaption>each at its place and size</figcaption></figure>
<figure><canvas></canvas><figcaption>one depth map, and masks</figcaption></figure>
<script type="module">
const inputs = ${JSON.stringify(inputs)};
const canvas = document.querySelector("canvas");
Object.assign(canvas, { width: inputs.width, height: inputs.height });
const { width, height, pixels } = inputs;
canvas.getContext("2d").putImageData(new ImageData(Uint8ClampedArray.from(pixels), width, height), 0, 0);
${drawing}
</script>`;

/**
 * A PNG.
 * @param {Browser} browser
 * @param {Buffer} placed the 3D view
 */
export async function readmePicture(browser, placed) {
  const files = await serve(at());
  const drawn = await browser.newPage({ viewport: { width: 1200, height: 470 } });
  try {
    // Which axis is up in each mesh.
    const ups = { duck: [0, 0, 1], mug: [0, 1, 0], box: [0, 1, 0] };
    const meshes = Object.entries(ups).map(([name, up]) => [name, `/www/samples/kitchen/objects/${name}/mesh.glb`, up]);
    const body = page(`data:image/png;base64,${placed.toString("base64")}`, { ...(await observation()), meshes });
    await drawn.route("**/readme.html", (route) => route.fulfill({ contentType: "text/html", body }));
    await drawn.goto(`${files.url}readme.html`);
    await drawn.locator('[data-state="done"]').waitFor();
    return await drawn.screenshot();
  } finally {
    await drawn.close();
    await files.close();
  }
}
