/**
 * Conversions to and from the conventions of other tools: frames, matrices, quaternions, masks, depth, cameras and
 * files. Needs no WebAssembly.
 *
 * Unless noted otherwise, the camera frame is OpenCV's (x right, y down, z forward), lengths are in metres,
 * quaternions are x, y, z, w, matrices are column-major, and pixel centres have integer coordinates.
 * @packageDocumentation
 */
export { type BopPose, fromBop, toBop } from "./conventions/bop.js";
export { type Cuboid, type CuboidOptions, type MeshAxis, toCuboid } from "./conventions/cuboid.js";
export { type CvatCuboid, fromCvatCuboid, toCvatCuboid } from "./conventions/cvat-cuboid.js";
export { type CvatMaskElement, fromCvatRle } from "./conventions/cvat-rle.js";
export { correctDepth, depthFromDisparity, depthFromRayDistance } from "./conventions/depth.js";
export {
  type CameraFrame,
  fromFrame,
  type RosPose,
  type ThreePose,
  toFrame,
  toRos,
  toThree,
} from "./conventions/frames.js";
export {
  type GeneratorFrame,
  generatorFrames,
} from "./conventions/generators.js";
export { exportGlb, type GlbOptions, placeGlb } from "./conventions/glb.js";
export { type GltfNode, type GltfNodeOptions, toGltfNode } from "./conventions/gltf-node.js";
export { fromLabelStudioRle } from "./conventions/label-studio-rle.js";
export { type MogeOutput, pointMapFromMoge } from "./conventions/moge.js";
export { type OrientedBoundingBox, orientedBoundingBox } from "./conventions/oriented-bounding-box.js";
export { exportPly } from "./conventions/ply.js";
export {
  type CropInput,
  cropInput,
  maskBox,
  type PixelBox,
  resizeCamera,
  resizeDepth,
  resizeMask,
} from "./conventions/resize.js";
export { wxyzFromXyzw, xyzwFromWxyz } from "./conventions/rotation.js";
export { fromSam3d, type Nested, type Sam3dLayout, type Sam3dVertices, toSam3d } from "./conventions/sam3d.js";
export { exportSceneGlb, type SceneGlbObject, type SceneGlbOptions } from "./conventions/scene-glb.js";
export { applyToPoints, compose, invert, toRowMajor, toSim3 } from "./conventions/similarity.js";
export { placeSplats } from "./conventions/splats.js";
export { type StretchLike, stretchGlb, stretchMesh } from "./conventions/stretch.js";
export { depthFromTensor, maskFromTensor, type TensorLike } from "./conventions/tensor.js";
export { type Upright, type UprightOptions, uprightGlb, uprightMesh } from "./conventions/upright.js";
export { fromCocoRle, toCocoRle } from "./input/coco-rle.js";
export { Sim3AlignError } from "./values/error.js";
export type { DepthPixels, ImageSize, MaskPixels } from "./values/pixels.js";
export type { Quaternion, Vector3 } from "./values/values.js";
