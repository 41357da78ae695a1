// A scene from the side: the support that was found in its depth map, and the meshes.
import { readMesh, readScene } from "sim3align/formats.js";
import { figure, legend } from "./cells.js";

const folder = "/www/samples/table/";
const names = ["box", "mug", "teapot"];
const [width, height] = [560, 210];
/** Metres from the left to the right of the view, and below the support. */
const [span, below] = [0.62, 0.03];
const COLOURS = ["#16827a", "#2f6fd0", "#e08a2c"];
const SUPPORT = "#d73c32";

const fetched = async (path) => new Uint8Array(await (await fetch(folder + path)).arrayBuffer());

/** Draws the objects of the sample with a photo, aligned together. */
export async function drawScene(aligner, picture) {
  const paths = ["depth.png", "camera.json", "rgb.png"];
  paths.push(...names.flatMap((name) => ["mask.png", "mesh.glb"].map((file) => `objects/${name}/${file}`)));
  const files = Object.fromEntries(await Promise.all(paths.map(async (path) => [path, await fetched(path)])));
  const { objects, support } = await aligner.alignScene((await readScene(files)).input);
  const point = sideOf(support);
  const shapes = await Promise.all(
    objects.map(async (object) => {
      const { positions, indices } = await readMesh(files[`objects/${object.name}/mesh.glb`]);
      return { indices, points: placed(positions, object).map(point) };
    }),
  );
  const gaps = objects.map(({ name, contact }, k) => {
    return { colour: COLOURS[k], text: `${name}: gap ${(1000 * contact.gapM).toFixed(1)} mm` };
  });
  const words = legend([...gaps, { colour: SUPPORT, text: "the support that was found" }]);
  picture("scene", figure(drawn(shapes), "three objects from the side"), words);
}

/** From the camera frame to a view along the support: across it as the camera sees it, and up, metres. */
function sideOf({ normal, d }) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const level = [1, 0, 0].map((x, k) => x - normal[0] * normal[k]);
  const length = Math.hypot(...level);
  return (x) => [dot(level, x) / length, dot(normal, x) + d];
}

const placed = (positions, { matrix: m }) =>
  Array.from({ length: positions.length / 3 }, (_, i) => {
    const [x, y, z] = positions.subarray(3 * i, 3 * i + 3);
    return [0, 1, 2].map((k) => m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k]);
  });

function drawn(shapes) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * width, 2 * height];
  canvas.style.width = `${width}px`;
  const context = canvas.getContext("2d");
  const scale = (2 * width) / span;
  const at = ([across, up]) => [width + across * scale, 2 * height - (up + below) * scale];
  context.globalAlpha = 0.75;
  for (const [k, { indices, points }] of shapes.entries()) {
    context.fillStyle = COLOURS[k];
    context.beginPath();
    for (let i = 0; i < indices.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((corner) => at(points[indices[i + corner]]));
      // All triangles turn the same way, so that those behind others do not cut holes.
      const isLeft = (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
      for (const [n, corner] of (isLeft ? [a, b, c] : [a, c, b]).entries()) {
        if (n === 0) context.moveTo(...corner);
        else context.lineTo(...corner);
      }
      context.closePath();
    }
    context.fill("nonzero");
  }
  const [, ground] = at([0, 0]);
  context.globalAlpha = 1;
  context.fillStyle = SUPPORT;
  context.fillRect(0, ground, 2 * width, 3);
  return canvas;
}
