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
  const write = (/** @type {string} */ name, /** @type {string | Uint8Array} */ content) => {
    const path = join(folder, name);
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, content);
  };
  /** @type {any} */
  const known = JSON.parse(readFileSync(join(truth, "truth.json"), "utf8"));
  const { pose, camera } = known;
  const mesh = {
    positions: Float32Array.from(known.points.flat(), (/** @type {number} */ each) => each / SCALE),
    indices: Uint32Array.from(known.triangles.flat()),
  };
  const transform = { ...pose, scale: SCALE };
  const glb = readFileSync(join(truth, "texture.glb"));
  write("node.glb", conventions.exportGlb(mesh, transform));
  write("baked.glb", conventions.exportGlb(mesh, transform, { mode: "baked" }));
  write("node-opencv.glb", conventions.exportGlb(mesh, transform, { frame: "opencv" }));
  // The GLB of the body is in metres.
  write("textured.glb", conventions.exportGlb(glb, pose));
  write("placed.ply", conventions.exportPly(mesh, transform));

  // The plane below the body, in the frame of the camera.
  const place = (/** @type {number[]} */ point) =>
    Array.from(conventions.applyToPoints(pose, Float64Array.from(point)));
  const [origin, above] = [place([0, 0, known.corner[2]]), place([0, 0, known.corner[2] + 1])];
  const normal = /** @type {[number, number, number]} */ (above.map((each, k) => each - (origin[k] ?? 0)));
  const support = { normal, d: -normal.reduce((sum, each, k) => sum + each * (origin[k] ?? 0), 0) };
  write("scene.glb", conventions.exportSceneGlb([{ name: "body", mesh: glb, transform: pose }], { support, camera }));
  write("scene-camera.glb", conventions.exportSceneGlb([{ name: "body", mesh: glb, transform: pose }], { camera }));

  const colored = await readMesh(glb);
  for (const rest of [false, true]) {
    const name = rest ? "rest" : "found";
    const scene = await simulators.simulatorScene([{ name: "body", mesh: colored, transform: pose }], {
      support,
      camera,
      rest,
      density: DENSITY,
    });
    const files = {
      mjcf: simulators.toMjcf(scene),
      urdf: simulators.toUrdf(scene),
      usd: { "scene.usda": simulators.toUsd(scene) },
    };
    for (const [format, texts] of Object.entries(files)) {
      for (const [path, text] of Object.entries(texts)) write(`${name}/${format}/${path}`, text);
    }
    const [body] = scene.bodies;
    write(
      `${name}/scene.json`,
      JSON.stringify({ ...body, mesh: undefined, parts: body?.parts.length, camera: scene.camera }),
    );
  }

  const { entry } = conventions.toBop(transform, { objId: 1 });
  write("scene_gt.json", JSON.stringify({ 0: [entry] }));
  const mask = {
    data: new Uint8Array(readFileSync(join(truth, "mask.u8"))),
    width: camera.width,
    height: camera.height,
  };
  write("mask.json", JSON.stringify(conventions.toCocoRle(mask)));
  write("mask-plain.json", JSON.stringify(conventions.toCocoRle(mask, { compressed: false })));
  const image = { id: 1, file_name: "rgb.png", width: camera.width, height: camera.height };
  const coco = (/** @type {object} */ segmentation, iscrowd = 0) => {
    const annotation = { id: 1, image_id: 1, category_id: 1, iscrowd, segmentation, bbox: [0, 0, 1, 1], area: 1 };
    return JSON.stringify({ images: [image], annotations: [annotation], categories: [{ id: 1, name: "body" }] });
  };
  write("coco.json", coco(conventions.toCocoRle(mask)));
  write("coco-crowd.json", coco(conventions.toCocoRle(mask, { compressed: false }), 1));

  const box = conventions.orientedBoundingBox(mesh, transform);
  const cuboid = conventions.toCuboid(box);
  write(
    "cuboid.json",
    JSON.stringify({
      cuboid,
      corners: Array.from(box.corners),
      points: conventions.toCvatCuboid(cuboid),
      toCamera: conventions.fromFrame({ scale: 1, rotation: [0, 0, 0, 1], translation: [0, 0, 0] }, "ros").matrix,
    }),
  );
  const forms = {
    opencv: conventions.toSim3(transform),
    opengl: conventions.toFrame(transform, "opengl"),
    pytorch3d: conventions.toFrame(transform, "pytorch3d"),
    ros: conventions.toFrame(transform, "ros"),
  };
  const poses = Object.entries(forms).map(([frame, form]) => [
    frame,
    {
      scale: form.scale,
      rotation: form.rotation,
      translation: form.translation,
      matrix: Array.from(form.matrix),
      rows: Array.from(conventions.toRowMajor(form)),
    },
  ]);
  write("poses.json", JSON.stringify(Object.fromEntries(poses)));
  const splats = readFileSync(at("tests", "fixtures", "splat.ply"));
  write("splats.ply", conventions.placeSplats(splats, transform));
  write("splats.json", JSON.stringify({ scale: SCALE, source: at("tests", "fixtures", "splat.ply") }));
  write("splats.splat", conventions.placeSplats(readFileSync(at("tests", "fixtures", "mesh.splat")), transform));
}
