// A mug seen by two depth cameras over a table, with known and with unknown camera poses: node align-views.mjs
import { createAligner } from "sim3align";
import { compose, invert } from "sim3align/conventions";
import { cameras, frames, mesh, truth } from "./table.mjs";

const aligner = await createAligner();

// 1. One camera. Nothing tells the far side, and the outline of the mask counts for the size.
const alone = await aligner.align({ mesh, ...frames[0] });

// 2. Both, calibrated: one pose in the world, from the evidence of both.
const views = frames.map((frame, k) => ({ ...frame, cameraToWorld: cameras[k] }));
const known = await aligner.alignViews({ mesh, views });

// 3. The same with the mask of the first camera alone. In the second, it follows from the pose.
const oneMask = await aligner.alignViews({ mesh, views: [views[0], { ...views[1], mask: undefined }] });

// 4. Both, not calibrated: one size, a pose in each, and the pose of the second camera in the frame of the first.
const unknown = await aligner.alignViews({ mesh, views: frames });
const second = unknown.views[1].camera;

const report = {
  alone: { confidence: alone.confidence, poses: [poseOf(alone)], errors: [await errorsOf(0, alone)] },
  known: await reportOf(known),
  oneMask: await reportOf(oneMask),
  unknown: {
    ...(await reportOf(unknown)),
    secondCamera: { ...poseOf(second), rotationSdDeg: second.rotationSdDeg, positionSdM: second.positionSdM },
  },
};
console.log(JSON.stringify(report, null, 2));

/** @param {import("sim3align").ViewsAlignment} found */
async function reportOf({ world, confidence, uncertainty, views, ...found }) {
  const poses = views.map(poseOf);
  const errors = await Promise.all(views.map((view, k) => errorsOf(k, view)));
  return { world, pose: poseOf(found), confidence, scaleSd: uncertainty?.scale, poses, errors };
}

/** Compares a pose in a camera with the truth. */
async function errorsOf(k, pose) {
  const cameraFromMesh = compose(invert({ matrix: cameras[k] }), { matrix: truth });
  const { errors } = await aligner.evaluate({ mesh, ...frames[k] }, pose, { truth: cameraFromMesh });
  return errors;
}

function poseOf({ scale, rotation, translation }) {
  return { scale, rotation, translation };
}
