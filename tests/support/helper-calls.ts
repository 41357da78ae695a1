/** A valid call of each function that the entries without an aligner export. */
import * as conventions from "sim3align/conventions";
import * as formats from "sim3align/formats";
import * as simulators from "sim3align/simulators";
import * as three from "sim3align/three";
import { glb, gltfJson, npy, png } from "./files.js";
import { cuboid } from "./scene.js";
import { splatOf, splatRecords } from "./splats.js";

/** The entries, by their names in imports. */
export const entries: Readonly<Record<string, Readonly<Record<string, unknown>>>> = {
  ...{ conventions, formats, simulators, three },
};

const size = { width: 4, height: 3 };
const pixels = 12;
const camera = { fx: 5, fy: 5, cx: 1.5, cy: 1 };
const mesh = cuboid(0.1, 0.2, 0.3);
const pose = { scale: 0.1, rotation: [0, 0, 0, 1], translation: [0, 0, 1] };
const depth = { data: new Float32Array(pixels).fill(1), ...size };
const mask = { data: new Uint8Array(pixels).fill(1), ...size };
const box = { left: 1, top: 0, width: 2, height: 2 };
const sides = { sizeM: [1, 1, 1], centerM: [0, 0, 1], rotation: [0, 0, 0, 1] };
const cuboidOfTool = { center: [0, 0, 1], size: [1, 1, 1], quaternion: [0, 0, 0, 1] };
const support = { normal: [0, -1, 0], d: 1 };
const files = {
  ...{ "depth.npy": npy(depth.data, 3, 4), "mask.png": png(mask.data, 4, 3), "mesh.glb": glb(mesh) },
  "camera.json": Buffer.from(JSON.stringify({ ...camera, ...size })),
};
const inScene = Object.fromEntries(
  Object.entries(files).map(([name, file]) => [/mask|mesh/.test(name) ? `objects/mug/${name}` : name, file]),
);
const scene = await simulators.simulatorScene([{ name: "mug", mesh, transform: pose as never }], { maxParts: 1 });

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const settable = { set() {} };
const placed = { matrixWorld: { elements: identity }, updateWorldMatrix() {} };
const object = {
  ...{ ...placed, position: settable, quaternion: settable, scale: settable },
  ...{ matrix: { elements: identity }, updateMatrix() {} },
};
const attribute = { count: 3, getX: (i: number) => i, getY: (i: number) => i * i, getZ: () => 0 };
const lens = { near: 0.1, far: 10, ...size };
const viewer = { fov: 1, aspect: 1, near: 1, far: 2, zoom: 1, filmOffset: 0, setViewOffset() {} };

/** Their arguments, by entry and function. */
export const helperCalls: Readonly<Record<string, Readonly<Record<string, readonly unknown[]>>>> = {
  conventions: {
    applyToPoints: [pose, mesh.positions],
    compose: [pose, pose],
    depthFromCode: [{ data: new Uint16Array(pixels).fill(800), ...size }, "lerobot", { depthFar: 10 }],
    correctDepth: [depth, { depthKind: "scale-invariant", scale: 2, shift: 0 }],
    cropInput: [{ depth, mask, camera }, box],
    exportGlb: [mesh, pose, { mode: "node", frame: "opengl", name: "mug" }],
    exportPly: [mesh, pose],
    exportSceneGlb: [[{ name: "mug", mesh, transform: pose }], { support, camera: { fy: 5, ...size } }],
    fromBop: [{ cam_R_m2c: [1, 0, 0, 0, 1, 0, 0, 0, 1], cam_t_m2c: [0, 0, 1] }, { scale: 1 }],
    fromCvatCuboid: [[0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0]],
    fromFrame: [pose, "ros"],
    fromRle: [{ rle: "1,1", left: 0, top: 0, width: 2, height: 1 }, "cvat", size],
    fromSam3d: [{ scale: 1, rotation: [1, 0, 0, 0], translation: [0, 0, 1] }, { vertices: "glb" }],
    fromTensor: [{ data: mask.data, dims: [1, 3, 4] }, "mask", { index: 0 }],
    invert: [pose],
    orientedBoundingBox: [mesh, pose, { box: "axes" }],
    placeSplats: [splatRecords(splatOf(mesh)), pose, { frame: "opencv" }],
    pointMapFromMoge: [{ points: new Float32Array(3 * pixels).fill(1), mask: mask.data, ...size }],
    resizeInput: [
      { depth, mask, camera },
      { width: 8, height: 6 },
    ],
    stretchMesh: [mesh, { stretch: [1, 0, 0, 0, 1, 0, 0, 0, 1] }],
    bopSymmetries: [[{ axis: [0, 1, 0], fold: 2 }], mesh, { scale: 0.01 }],
    toBop: [pose, { objId: 1 }],
    toCocoRle: [mask, { compressed: false }],
    toCuboid: [sides, { frame: "ros", front: "z", up: "y" }],
    toCvatCuboid: [cuboidOfTool],
    toFrame: [pose, "ros"],
    toRowMajor: [pose],
    toSam3d: [pose, { vertices: "glb" }],
    toSim3: [pose],
    uprightMesh: [mesh, pose, { support, up: "y" }],
  },
  formats: {
    externalResources: [Buffer.from(JSON.stringify(gltfJson(mesh)))],
    focalFromExif: [{ focalLength35mm: 28, orientation: 1, ...size }, size],
    loadFormats: [],
    readCamera: [{ ...camera, ...size }, {}],
    readCase: [files, {}],
    readDepth: [files["depth.npy"], { depthScale: 1 }],
    readExif: [files["mask.png"]],
    readFrames: [files, {}],
    readImage: [files["mask.png"]],
    readMask: [files["mask.png"]],
    readMesh: [files["mesh.glb"], { format: "glb", colors: true }],
    readPose: [pose],
    readSam3d: [{ "depth.npy": files["depth.npy"], "mug.png": files["mask.png"], "mug.glb": files["mesh.glb"] }, {}],
    readScene: [inScene, {}],
  },
  simulators: {
    simulatorScene: [[{ name: "mug", mesh, transform: pose }], { support, camera: { fy: 5, ...size }, maxParts: 1 }],
    toMjcf: [scene],
    toUrdf: [scene],
    toUsd: [scene],
  },
  three: {
    applyPinhole: [{ ...viewer, updateProjectionMatrix() {} }, camera, lens],
    applyToObject3D: [object, pose, { frame: "opengl", camera: placed }],
    cameraFromPinhole: [camera, lens],
    meshInputFromThree: [{ attributes: { position: attribute }, index: null }, { frame: "object" }],
    transformFromObject3D: [object, { frame: "opengl" }],
  },
};
