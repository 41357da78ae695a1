// From a pose set by hand to an exported annotation: node annotate.mjs [FOLDER] [OUT_FOLDER]
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { compose, objectDimensions, placeGlb, toBop } from "sim3align/conventions";
import { readMesh } from "sim3align/formats";

const [folder = "../sample/mug", out = "annotation"] = process.argv.slice(2);
const [depth, mask, cameraFile, glb] = await Promise.all(
  ["depth.npy", "mask.png", "camera.json", "mesh.glb"].map((name) => readFile(`${folder}/${name}`)),
);
const mesh = await readMesh(glb);
const input = { depth, mask, cameraFile, mesh };
const aligner = await createAligner({ workers: 1 });

// 1. What the tool proposes, and what else would explain the picture: the annotator chooses.
const proposal = await aligner.align(input);
for (const { turnDeg, score } of [{ turnDeg: 0, score: proposal.diagnostics.score }, ...proposal.alternatives]) {
  console.log(`proposal turned by ${turnDeg.toFixed(0)}°: score ${score.toFixed(3)}`);
}

// 2. The annotator drags the object: here by 12° about the camera's y axis and 2 cm to the right, 8 % too large.
const half = (12 * Math.PI) / 360;
const [tx, ty, tz] = proposal.translation;
const aboutCentre = compose(
  { scale: 1.08, rotation: [0, Math.sin(half), 0, Math.cos(half)], translation: [tx + 0.02, ty, tz] },
  { scale: 1, rotation: [0, 0, 0, 1], translation: [-tx, -ty, -tz] },
);
const dragged = compose(aboutCentre, proposal);

// 3. The tool snaps it into place, from there and no farther.
const refined = await aligner.align(input, { initial: dragged, search: "local" });

// 4. The annotator knows a dimension: the scale is fixed, and the rest follows. Here: the height that was found.
const { sizeM } = objectDimensions(mesh, refined);
const knownExtentM = Math.round(1000 * sizeM[1]) / 1000;
const { scale, ...pose } = refined;
const sized = { scale: scale * (knownExtentM / sizeM[1]), rotation: pose.rotation, translation: pose.translation };
const locked = await aligner.align(input, {
  ...{ initial: sized, search: "local" },
  ...{ knownExtentM, knownExtentAxis: "y" },
});
aligner.dispose();

// 5. The annotation: BOP's pose, whose model is in millimetres at its real size, and a GLB in its place.
const { entry, scale: metresPerUnit } = toBop(locked, { objId: 1 });
await mkdir(out, { recursive: true });
await writeFile(`${out}/scene_gt.json`, JSON.stringify({ 0: [entry] }, null, 2));
await writeFile(`${out}/placed.glb`, placeGlb(glb, locked));
const summary = {
  knownExtentM,
  sizeM: objectDimensions(mesh, locked).sizeM,
  modelMmPerUnit: 1000 * metresPerUnit,
  poses: [dragged, refined, locked].map(({ matrix }) => matrix),
  scores: [proposal, refined, locked].map(({ diagnostics }) => diagnostics.score),
  uncertainty: locked.uncertainty,
};
await writeFile(`${out}/annotation.json`, JSON.stringify(summary, null, 2));
console.log(`${out}/: scene_gt.json, placed.glb, annotation.json`);
