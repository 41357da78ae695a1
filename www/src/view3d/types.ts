/** The interface of the 3D view. */

/** Camera from mesh, 16 numbers, column-major; OpenCV camera frame, metres. */
export type Matrix = ArrayLike<number>;

/** The observation: a depth map with its camera. */
export interface SceneInput {
  /** z-depth in metres, row-major; 0 or NaN is no reading. */
  depthM: Float32Array;
  width: number;
  height: number;
  /** In pixels; pixel centres are at integers. */
  camera: { fx: number; fy: number; cx: number; cy: number };
  /** The image behind the meshes in the view from the depth camera; none by default. */
  ground?: Uint8ClampedArray | undefined;
  /** The photo at the size of the depth map. Without it, points are coloured by depth. */
  rgba?: Uint8ClampedArray | undefined;
}

/** An object: its mask and its mesh. */
export interface ObjectInput {
  id: string;
  /** For the description of the view. */
  name?: string | undefined;
  /** A CSS colour for the points of the mask, the outline, and a mesh without colours. */
  colour: string;
  /** One number per pixel of the depth map; not 0 is the object. */
  mask: Uint8Array;
  /** A GLB or arrays, in the frame of the mesh. */
  mesh: { glb: Uint8Array } | { positions: Float32Array; indices: Uint32Array };
  /** The corners of the box whose sides are its sizes, bit k of an index for side k; by default, along the mesh's axes. */
  corners?: readonly (readonly [number, number, number])[] | undefined;
}

/** Display settings. */
export interface Display {
  cloud: boolean;
  mesh: boolean;
  wireframe: boolean;
  /** The width of a point in pixels of the depth map. At 1, adjacent points touch. */
  pointSize: number;
  theme: "light" | "dark";
  /** Whether there are views from above, from the side and from the front. */
  planes?: boolean | undefined;
  /** Whether the sizes of the objects are shown. */
  dimensions?: boolean | undefined;
  /** What lengths are shown as multiples of; by default, they are in metres. */
  unit?: number | null | undefined;
  /** The ids of the objects that are not shown. */
  hidden?: readonly string[] | undefined;
  /** The ids of the objects without a result: the size of a start pose is none. */
  unplaced?: readonly string[] | undefined;
}

/** Viewpoints: the depth camera, a three-quarter view, from above, from the right. */
export type Look = "camera" | "orbit" | "top" | "side";

/** The function of the gizmo. */
export type GizmoMode = "translate" | "rotate" | "scale";

/** How the gizmo moves. */
export interface GizmoSettings {
  /** Along the axes of the mesh instead of those of the view. */
  isLocal: boolean;
  /** In steps of 5° and of a hundredth of the object's size. */
  snaps: boolean;
}

/** A plane n·x + d = 0 in the OpenCV camera frame, metres; n points up. */
export interface PlaneInput {
  normal: readonly [number, number, number];
  d: number;
}

/** The start and duration of an animation. */
export interface Animation {
  from: Matrix;
  durationMs: number;
  /** How long it stays where it is. */
  delayMs?: number | undefined;
}

/** Events of the view. */
export interface ViewEvents {
  /** The gizmo moves or has moved an object. */
  onPose(id: string, pose: Float64Array, phase: "drag" | "end"): void;
  /** A mesh or the points of a mask were clicked; `null` for neither. */
  onSelect(id: string | null): void;
  /** The pixel of the depth map under the pointer. */
  onHover?(pixel: { x: number; y: number } | null): void;
}
