// Aligns many case folders in parallel: node batch.mjs [--out NAME] FOLDER...
import { readFile, writeFile } from "node:fs/promises";
import { basename } from "node:path";
import { parseArgs } from "node:util";
import { stringify } from "csv-stringify/sync";
import { createAligner } from "sim3align";

const { values, positionals: folders } = parseArgs({
  allowPositionals: true,
  options: { out: { type: "string", default: "results" }, workers: { type: "string", default: "auto" } },
});
if (folders.length === 0) folders.push("../sample/mug");

/** Reads each case on demand, so that thousands of cases do not fill the memory. */
async function* cases() {
  for (const folder of folders) {
    const file = (/** @type {string} */ name) => readFile(`${folder}/${name}`);
    const [depth, mask, cameraFile, mesh] = await Promise.all([
      file("depth.npy").catch(() => file("depth.png")),
      file("mask.png"),
      file("camera.json"),
      file("mesh.glb").catch(() => file("mesh.obj")),
    ]);
    yield { depth, mask, cameraFile, mesh };
  }
}

const workers = values.workers === "auto" ? values.workers : Number(values.workers);
const aligner = await createAligner({ workers });
const rows = [];
const records = [];
// Results come in the order of the folders. A case that fails does not stop the others.
for await (const { index, alignment, error } of aligner.alignAll(cases(), { ordered: true })) {
  const folder = folders[index] ?? "";
  console.error(`${index + 1}/${folders.length} ${folder}: ${error?.message ?? `confidence ${alignment?.confidence}`}`);
  const { scale, translation, rotation, confidence, alternatives, metrics } = alignment ?? {};
  const [x, y, z] = translation ?? [];
  const [qx, qy, qz, qw] = rotation ?? [];
  const transform = { scale, x, y, z, qx, qy, qz, qw };
  rows.push({
    case: basename(folder),
    error: error?.code,
    ...transform,
    confidence,
    alternatives: alternatives?.length,
    iou: metrics?.iou,
  });
  records.push({ folder, error: error?.code, ...alignment });
}
aligner.dispose();
await writeFile(`${values.out}.csv`, stringify(rows, { header: true }));
await writeFile(`${values.out}.json`, JSON.stringify(records, null, 2));
if (rows.some(({ error }) => error !== undefined)) process.exitCode = 1;
