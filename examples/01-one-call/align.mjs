// Four files in, one transform out: node align.mjs [FOLDER]
import { readFile } from "node:fs/promises";
import { createAligner } from "sim3align";

const folder = process.argv[2] ?? "../sample/mug";
const [depth, mask, cameraFile, mesh] = await Promise.all(
  ["depth.npy", "mask.png", "camera.json", "mesh.glb"].map((name) => readFile(`${folder}/${name}`)),
);

const aligner = await createAligner();
const result = await aligner.align({ depth, mask, cameraFile, mesh });

const { scale, rotation, translation, matrix, confidence } = result;
console.log(JSON.stringify({ scale, rotation, translation, matrix, confidence }, null, 2));
