// A video annotated with the mask of its first frame and one correction: node annotate-video.mjs [OUT_FOLDER]
import { mkdir, writeFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { FRAMES, frameAt, mesh } from "./video.mjs";

const [out = "annotations"] = process.argv.slice(2);
/** The frame in which the annotator corrects the pose. */
const CORRECTED = 20;

await mkdir(out, { recursive: true });
const annotations = [];

/** Writes the annotation of a frame, or writes it again. */
async function write(annotation) {
  annotations[annotation.frame] = annotation;
  const name = `frame_${String(annotation.frame).padStart(2, "0")}.json`;
  await writeFile(`${out}/${name}`, `${JSON.stringify(annotation, null, 2)}\n`);
}

const aligner = await createAligner({ workers: 1 });
const tracker = await aligner.track(mesh);
for (let k = 0; k < FRAMES; k++) {
  const { truth, mask, ...frame } = frameAt(k);

  // 1. Only the first frame has a mask. In the others, the last silhouette, moved on, says where to look.
  const found = await tracker.next(k === 0 ? { ...frame, mask } : frame);
  const { state, confidence, scale, rotation, translation } = found;
  await write({ frame: k, state, confidence, isCorrected: false, scale, rotation, translation });
  if (state !== "tracking") console.log(`frame ${k} is to be checked: ${state}, confidence ${confidence.toFixed(2)}`);

  // 2. In the middle, the annotator sets the pose by hand, here to the truth: the size was measured with a ruler.
  if (k === CORRECTED) {
    // 3. The frames before follow: their annotations are written again. The next frames start at the correction.
    for (const corrected of await tracker.correct(truth)) {
      const { frame: at, scale, rotation, translation } = corrected;
      await write({ ...annotations[at], isCorrected: true, scale, rotation, translation });
    }
    console.log(`correction of ${(100 * (truth.scale / scale - 1)).toFixed(1)} % in frame ${k}`);
  }
}
tracker.dispose();
aligner.dispose();

const poses = annotations.map(({ scale, rotation, translation }) => ({ scale, rotation, translation }));
await writeFile(`${out}/poses.json`, `${JSON.stringify(poses, null, 2)}\n`);
const count = annotations.filter(({ isCorrected }) => isCorrected).length;
console.log(`${out}/: ${annotations.length} frames, ${count} of them corrected`);
