// node main.mjs PHOTO MESH U,V [EXTENT_M]: aligns a mesh with the object at (U, V) of a photo, shares of its width and height.
// With the longest extent of the object in metres, the result is metric. transformers.js downloads the models on the first run.
import { readFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { alignTensors } from "./align-tensors.mjs";
import { loadModels } from "./models.mjs";

const [photoFile, meshFile, place, extent] = process.argv.slice(2);
if (!photoFile || !meshFile || !place) throw new Error("Usage: node main.mjs PHOTO MESH U,V [EXTENT_M]");
const transformers = await import("@huggingface/transformers").catch(() => {
  throw new Error("transformers.js is missing. Remedy: npm install @huggingface/transformers");
});

const see = await loadModels(transformers);
const [photo, mesh] = await Promise.all([photoFile, meshFile].map((path) => readFile(path)));
const found = await see(new Blob([photo]), place.split(",").map(Number));
const aligner = await createAligner();
const options = extent === undefined ? {} : { knownExtentM: Number(extent) };
const { scale, translation, confidence, cameraSource, depthCalibration } = await alignTensors(
  ...[aligner, found, photo, mesh, options],
);
console.log({ scale, translation, confidence, cameraSource, depthCalibration });
