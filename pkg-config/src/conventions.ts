/**
 * Conversions to and from the conventions of other tools: frames, matrices, quaternions, masks, depth, cameras and
 * files. Needs no WebAssembly.
 *
 * Unless noted otherwise, the camera frame is OpenCV's (x right, y down, z forward), lengths are in metres,
 * quaternions are x, y, z, w, matrices are column-major, and pixel centres have integer coordinates.
 * @packageDocumentation
 */
export { bopSymmetries, fromBop, toBop } from "./conventions/bop.js";
export { toCuboid } from "./conventions/cuboid.js";
export { fromCvatCuboid, toCvatCuboid } from "./conventions/cvat-cuboid.js";
export { correctDepth } from "./conventions/depth.js";
export { fromFrame, toFrame } from "./conventions/frames.js";
export { generatorFrames } from "./conventions/generators.js";
export { exportGlb } from "./conventions/glb.js";
export { pointMapFromMoge } from "./conventions/moge.js";
export { orientedBoundingBox } from "./conventions/oriented-bounding-box.js";
export { exportPly } from "./conventions/ply.js";
export { cropInput, resizeInput } from "./conventions/resize.js";
export { fromRle } from "./conventions/rle.js";
export { fromSam3d, toSam3d } from "./conventions/sam3d.js";
export { exportSceneGlb } from "./conventions/scene-glb.js";
export { applyToPoints, compose, invert, toRowMajor, toSim3 } from "./conventions/similarity.js";
export { placeSplats } from "./conventions/splats.js";
export { stretchMesh } from "./conventions/stretch.js";
export { fromTensor } from "./conventions/tensor.js";
export { uprightMesh } from "./conventions/upright.js";
export { toCocoRle } from "./input/coco-rle.js";
export { depthFromCode } from "./input/depth-codes.js";
export { Sim3AlignError } from "./values/error.js";
