// From a pose set by hand to an exported annotation: node annotate.mjs [FOLDER] [OUT_FOLDER]
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { compose, exportGlb, orientedBoundingBox, toBop } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";

const [folder = "../sample/mug", out = "annotation"] = process.argv.slice(2);
const [depth, mask, cameraFile, glb] = await Promise.all(
  ["depth.npy", "mask.png", "camera.json", "mesh.glb"].map((name) => readFile(`${folder}/${name}`)),
);
const mesh = await readMesh(glb);
const aligner = await createAligner({ workers: 1 });
const prepared = await aligner.prepareMesh(mesh);
const input = { depth, mask, cameraFile, mesh: prepared };

// 1. The tool proposes a pose and its alternatives. The annotator chooses one.
const proposal = await aligner.align(input);
for (const { turnDeg, score } of [{ turnDeg: 0, score: proposal.diagnostics.score }, ...proposal.alternatives]) {
  console.log(`proposal turned by ${turnDeg.toFixed(0)}°: score ${score.toFixed(3)}`);
}

// 2. The annotator drags the object. Here: 12° about the y axis of the camera, 2 cm to the right, and 8 % too large.
const half = (12 * Math.PI) / 360;
const [tx, ty, tz] = proposal.translation;
const aboutCentre = compose(
  { scale: 1.08, rotation: [0, Math.sin(half), 0, Math.cos(half)], translation: [tx + 0.02, ty, tz] },
  { scale: 1, rotation: [0, 0, 0, 1], translation: [-tx, -ty, -tz] },
);
const dragged = compose(aboutCentre, proposal);

// 3. The tool refines the pose, and searches only near it.
const refined = await aligner.align(input, { initial: dragged, search: "local" });

// 4. The annotator knows a dimension, which fixes the scale. Here it is the height that was found, rounded to millimetres.
const { sizeM } = orientedBoundingBox(mesh, refined);
const knownExtentM = Math.round(1000 * sizeM[1]) / 1000;
const { scale, ...pose } = refined;
const sized = { scale: scale * (knownExtentM / sizeM[1]), rotation: pose.rotation, translation: pose.translation };
const locked = await aligner.align(input, {
  ...{ initial: sized, search: "local" },
  ...{ knownExtentM, knownExtentAxis: "y" },
});
aligner.dispose();

// 5. The annotation: a pose for BOP, whose model is in millimetres at its real size, and the placed GLB.
const { entry, scale: metresPerUnit } = toBop(locked, { objId: 1 });
await mkdir(out, { recursive: true });
await writeFile(`${out}/scene_gt.json`, JSON.stringify({ 0: [entry] }, null, 2));
await writeFile(`${out}/placed.glb`, exportGlb(glb, locked));
const summary = {
  knownExtentM,
  sizeM: orientedBoundingBox(mesh, locked).sizeM,
  modelMmPerUnit: 1000 * metresPerUnit,
  poses: [dragged, refined, locked].map(({ matrix }) => matrix),
  scores: [proposal, refined, locked].map(({ diagnostics }) => diagnostics.score),
  uncertainty: locked.uncertainty,
};
await writeFile(`${out}/annotation.json`, JSON.stringify(summary, null, 2));
console.log(`${out}/: scene_gt.json, placed.glb, annotation.json`);
