/** What we write of the known object at its known pose, for programs to load: `target/interop/ours`. */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { at, packageDir } from "../lib/paths.mjs";

/** @type {typeof import("../../pkg/formats.js")} */
const { readMesh } = await import(join(packageDir, "formats.js"));
/** @type {typeof import("../../pkg/conventions.js")} */
const conventions = await import(join(packageDir, "conventions.js"));
/** @type {typeof import("../../pkg/simulators.js")} */
const simulators = await import(join(packageDir, "simulators.js"));

/** Metres per unit of the mesh, as if a generator had made it. */
const SCALE = 0.25;
const DENSITY = 400;

/** Writes every kind of file. @param {string} folder @param {string} truth the folder of the known object */
export async function writeOurs(folder, truth) {
  const array = (/** @type {string} */ _, /** @type {any} */ each) =>
    ArrayBuffer.isView(each) ? Array.from(/** @type {any} */ (each)) : each;
  const write = (/** @type {string} */ name, /** @type {string | object} */ content) => {
    const path = join(folder, name);
    mkdirSync(dirname(path), { recursive: true });
    const isFile = typeof content === "string" || content instanceof Uint8Array;
    writeFileSync(path, isFile ? content : JSON.stringify(content, array));
  };
  const known = JSON.parse(readFileSync(join(truth, "truth.json"), "utf8"));
  const { pose, camera, support } = known;
  const mesh = {
    positions: Float32Array.from(known.points.flat(), (/** @type {number} */ each) => each / SCALE),
    indices: Uint32Array.from(known.triangles.flat()),
  };
  const transform = { ...pose, scale: SCALE };
  // This GLB of the body is in metres.
  const glb = readFileSync(join(truth, "texture.glb"));
  write("node.glb", conventions.exportGlb(mesh, transform));
  write("baked.glb", conventions.exportGlb(mesh, transform, { mode: "baked" }));
  write("node-opencv.glb", conventions.exportGlb(mesh, transform, { frame: "opencv" }));
  write("textured.glb", conventions.exportGlb(glb, pose));
  write("placed.ply", conventions.exportPly(mesh, transform));

  const placed = [{ name: "body", mesh: glb, transform: pose }];
  write("scene.glb", conventions.exportSceneGlb(placed, { support, camera }));
  write("scene-camera.glb", conventions.exportSceneGlb(placed, { camera }));

  const bodies = [{ name: "body", mesh: await readMesh(glb), transform: pose }];
  for (const name of ["found", "rest"]) {
    const options = { support, camera, rest: name === "rest", density: DENSITY };
    const scene = await simulators.simulatorScene(bodies, options);
    for (const [path, text] of Object.entries(simulators.toMjcf(scene))) write(`${name}/mjcf/${path}`, text);
    for (const [path, text] of Object.entries(simulators.toUrdf(scene))) write(`${name}/urdf/${path}`, text);
    write(`${name}/usd/scene.usda`, simulators.toUsd(scene));
    const [body] = scene.bodies;
    write(`${name}/scene.json`, { ...body, mesh: undefined, parts: body?.parts.length, camera: scene.camera });
  }

  const { width, height } = camera;
  const mask = { data: Uint8Array.from(known.mask.flat()), width, height };
  const coco = (/** @type {object} */ segmentation, iscrowd = 0) => ({
    images: [{ id: 1, file_name: "rgb.png", width, height }],
    annotations: [{ id: 1, image_id: 1, category_id: 1, iscrowd, segmentation, bbox: [0, 0, 1, 1], area: 1 }],
    categories: [{ id: 1, name: "body" }],
  });
  write("mask.json", conventions.toCocoRle(mask));
  write("coco.json", coco(conventions.toCocoRle(mask)));
  write("coco-crowd.json", coco(conventions.toCocoRle(mask, { compressed: false }), 1));

  const box = conventions.orientedBoundingBox(mesh, transform);
  const cuboid = conventions.toCuboid(box);
  write("cuboid.json", { cuboid, corners: box.corners, points: conventions.toCvatCuboid(cuboid) });
  write("scene_gt.json", { 0: [conventions.toBop(transform, { objId: 1 }).entry] });
  const poses = /** @type {const} */ (["opencv", "opengl", "pytorch3d", "ros"]).map((frame) => {
    const form = conventions.toFrame(transform, frame);
    return [frame, { ...form, rows: conventions.toRowMajor(form) }];
  });
  write("poses.json", Object.fromEntries(poses));
  const splats = at("tests", "fixtures", "splat.ply");
  write("splats.ply", conventions.placeSplats(readFileSync(splats), transform));
  write("splats.json", { scale: SCALE, source: splats });
}
