/** Outputs of SAM 3D Objects as scenes: names, frames, damage; and that its placement is no assumption. */
import assert from "node:assert/strict";
import { test } from "node:test";
import type { SceneInput } from "sim3align";
import { type CaseFiles, readDepth, readSam3d, readScene } from "sim3align/formats";
import { type Fault, rejectsWith } from "../support/errors.js";
import { type Files, fixture, maskPng, obj } from "../support/files.js";
import { assertNear } from "../support/random.js";
import { layoutOf, pointMapNpy, zUp } from "../support/sam3d.js";
import { columnMajor, type Pose, transformed } from "../support/scene.js";
import { splatPly } from "../support/splats.js";
import { standingGlb as glb, masks, poses, standingMesh, tableView } from "../support/table.js";

const { width, height, depth, camera } = tableView;
const [pose] = poses as [Pose];
const mask = maskPng(masks[0] as Uint8Array, width, height);
const points = pointMapNpy(tableView);
const layout = layoutOf(pose);

/** The object as Gaussians, in whose frame z is up. */
const gaussians = splatPly(
  Array.from({ length: standingMesh.positions.length / 3 }, (_, i) => ({
    position: zUp(Array.from(standingMesh.positions.subarray(3 * i, 3 * i + 3))),
    ...{ scales: [0.03, 0.03, 0.03], rotation: [1, 0, 0, 0], opacity: 0.99, color: [200, 100, 50], harmonics: [] },
  })),
);

/** JSON as bytes. */
const filesOf = (files: Files): CaseFiles =>
  Object.fromEntries(
    Object.entries(files).map(([path, content]) => {
      if (content instanceof Uint8Array) return [path, content];
      return [path, Buffer.from(typeof content === "string" ? content : JSON.stringify(content))];
    }),
  );
const read = (files: Files) => readSam3d(filesOf(files));
const matrixOf = ({ objects }: SceneInput) => (objects[0]?.initial as { matrix: number[] } | undefined)?.matrix;

const layouts: Record<string, Files> = {
  "as the guide has it": {
    ...{ "objects/thing/mask.png": mask, "objects/thing/mesh.glb": glb, "objects/thing/pose.json": layout },
  },
  "numbers of masks, as in its repository": { "0.png": mask, "0.glb": glb, "0.json": layout },
  "numbers in names": {
    ...{ "masks/mask_0.png": mask, "mask_1.png": mask, "meshes/mesh_000.glb": glb, "poses/pose_000.json": layout },
  },
  "one object, with Gaussians beside the mesh": {
    ...{ "mask.png": mask, "mesh.glb": glb, "gaussian.ply": gaussians, "metadata.json": { ...layout, seed: 42 } },
  },
  "Gaussians, whose z is up": { "mug/mask.png": mask, "mug/splat.ply": gaussians, "mug/pose.json": layout },
  "as sam3d_asset_extractor writes it, with copies in the camera's frame": {
    ...{ "sam2_masks/photo_000.png": mask, "sam2_masks/vis_photo.png": mask, "sam3d/photo_000_mesh.glb": glb },
    ...{
      "sam3d/photo_000_pose.json": layout,
      "sam3d/photo_000_pose_mesh.glb": "",
      "decimated/photo_000_pose_mesh.ply": "",
    },
  },
  "another format of the mesh": {
    ...{ "mug/mask.png": mask, "mug/mug.obj": obj(standingMesh), "mug/pose.json": layout },
  },
};

test("the usual names are found, below other folders too, and frames are converted", async () => {
  const vertex = Array.from(standingMesh.positions.subarray(30, 33));
  for (const [what, own] of Object.entries(layouts)) {
    const files = { "pointmap.npy": points, ...own };
    const below = Object.fromEntries(Object.entries(files).map(([path, content]) => [`run/7/${path}`, content]));
    for (const given of [files, below]) {
      const { input } = await read(given);
      assert.deepEqual([input.objects.length, input.depthKind], [1, "scale-invariant"], what);
      // A vertex of the GLB, or the same one of the Gaussians, is where the pose puts it.
      const [x = 0, y = 0, z = 0] = what.startsWith("Gaussians") ? zUp(vertex) : vertex;
      const m = matrixOf(input) ?? [];
      const at = [0, 1, 2].map((k) => (m[k] ?? 0) * x + (m[4 + k] ?? 0) * y + (m[8 + k] ?? 0) * z + (m[12 + k] ?? 0));
      assertNear(at, transformed(vertex, pose), what, 1e-5);
      const map = await readDepth(input.depth as Uint8Array);
      const { fx, fy, cx, cy } = map.camera ?? camera;
      assertNear([fx, fy, cx, cy], [camera.fx, camera.fy, camera.cx, camera.cy], what, 1e-4);
      assertNear(map.data, depth, what, 1e-5);
      assert.match(map.unit.source, /x left, y up, z forward/);
    }
  }
});

test("a point map may be in OpenCV's frame; depth in metres, and a file of MoGe, go before it", async () => {
  const own = { "0.png": mask, "0.glb": glb };
  const { input } = await read({ ...own, "pointmap.npy": pointMapNpy(tableView, 1) });
  const { fx, fy } = (await readDepth(input.depth as Uint8Array)).camera ?? { fx: 0, fy: 0 };
  assertNear([fx, fy], [camera.fx, camera.fy], "OpenCV", 1e-4);
  assert.equal(matrixOf(input), undefined);
  const metric = { ...own, "pointmap.npy": points, "depth.npy": points, "camera.json": camera };
  assert.equal((await read(metric)).input.depthKind, "metric");
  const moge = fixture("depth-moge.npz");
  const ofMoge = (await read({ ...own, "moge.npz": moge })).input;
  assert.deepEqual([ofMoge.depth, ofMoge.depthKind], [moge, "scale-invariant"]);
  const placed = (json: object) => read({ ...own, "pointmap.npy": points, "0.json": json });
  const mean = await placed(layoutOf(pose, [0.9, 1.2, 0.9]));
  assertNear(matrixOf(mean.input) ?? [], columnMajor(pose), "three sizes count as their mean", 1e-5);
  for (const z of [-1, 0.5 * pose.scale]) {
    const near = await placed(layoutOf({ ...pose, translation: [0, 0, z] }));
    assert.equal(matrixOf(near.input), undefined, "a placement at the camera is none");
  }
});

test("one of several masks is that of the object by its name; what is not read is named", async () => {
  const pictures = { "a/render.png": mask, "a/render_mask_2.txt": "", "b.png": mask, "poses.csv": "" };
  const { files, unread } = await read({ ...whole, ...pictures });
  const parts = { mask: "a/mask.png", mesh: "a/mesh.glb", initial: "a/pose.json" };
  const named = Object.entries(parts).map(([part, path]) => [`objects/a/${part}`, path]);
  assert.deepEqual(files, { depth: "pointmap.npy", ...Object.fromEntries(named) });
  assert.deepEqual(unread, ["a/render_mask_2.txt", "a/render.png", "b.png", "poses.csv"]);
});

const whole: Files = { "pointmap.npy": points, "a/mask.png": mask, "a/mesh.glb": glb, "a/pose.json": layout };
const without = (name: string): Files => Object.fromEntries(Object.entries(whole).filter(([path]) => path !== name));
const below = (folder: string): Files =>
  Object.fromEntries(Object.entries(whole).map(([path, content]) => [`${folder}/${path}`, content]));
const damaged: [what: string, files: Files, fault: Fault, words: RegExp][] = [
  ["no depth", without("pointmap.npy"), "FILE_NOT_FOUND sam3d", /pointmap\.npy/],
  ["no mask", without("a/mask.png"), "FILE_NOT_FOUND objects/a", /no mask of a/],
  ["no mesh", without("a/mesh.glb"), "FILE_NOT_FOUND objects/a", /no mesh of a/],
  ["two views", { ...below("a"), ...below("b") }, "INVALID_ARGUMENT sam3d", /a\/pointmap\.npy and b\/pointmap\.npy/],
  ["two masks", { ...whole, "a.png": mask, "a/mask.npy": mask }, "INVALID_ARGUMENT objects/a", /one mask/],
  ["two meshes", { ...whole, "a.glb": glb }, "INVALID_ARGUMENT objects/a", /a\.glb and a\/mesh\.glb/],
  ["two poses", { ...whole, "a.json": layout }, "INVALID_ARGUMENT objects/a", /a\.json and a\/pose\.json/],
  ["no object", { "pointmap.npy": points, "0.png": mask }, "FILE_NOT_FOUND scene", /no objects/],
  ["half a pose", { ...whole, "a/pose.json": '{"rotation": [1' }, "CORRUPT_FILE a/pose.json", /JSON/],
  ["a vector", { ...whole, "a/pose.json": { ...layout, rotation: [1, 0, 0] } }, "WRONG_LENGTH a/pose.json", /w first/],
  [
    "a matrix",
    { ...whole, "a/pose.json": { ...layout, rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1] } },
    "WRONG_LENGTH a/pose.json",
    /initial\.json/,
  ],
  ["no place", { ...whole, "a/pose.json": { ...layout, translation: null } }, "INVALID_ARGUMENT a/pose.json", /three/],
];
for (const [what, files, fault, words] of damaged) {
  test(`refused by name: ${what}`, () => rejectsWith(() => read(files), fault, words));
}

test("a first pose of a scene folder is a candidate", async () => {
  const own = { "mask.png": mask, "mesh.glb": glb, "initial.json": { matrix: columnMajor(pose) } };
  const objects = Object.entries(own).map(([name, content]) => [`objects/a/${name}`, content]);
  const { input } = await readScene(filesOf({ "depth.npy": points, ...Object.fromEntries(objects) }));
  assertNear(matrixOf(input) ?? [], columnMajor(pose), "initial.json", 1e-5);
});
