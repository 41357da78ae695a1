/** The 3D view's interface to the page. */

/** 16 numbers, column by column: the OpenCV camera frame, metres, from the mesh's. */
export type Matrix = ArrayLike<number>;

/** What was seen: a depth map, and its camera. */
export interface SceneInput {
  /** z-depth per pixel, metres, row by row; 0 or NaN where there is none. */
  depthM: Float32Array;
  width: number;
  height: number;
  /** In pixels; pixel centres are at whole numbers. */
  camera: { fx: number; fy: number; cx: number; cy: number };
  /** The photo at the depth's size; without it points are coloured by depth. */
  rgba?: Uint8ClampedArray | undefined;
}

/** A masked object, and the mesh that is to be aligned with it. */
export interface ObjectInput {
  id: string;
  /** A CSS colour: of the mask's points, of a mesh without colours of its own, of the outline. */
  colour: string;
  /** One number per pixel of the depth map, not 0 where the object is. */
  mask: Uint8Array;
  /** A binary glTF, or arrays, in the mesh's frame. */
  mesh: { glb: Uint8Array } | { positions: Float32Array; indices: Uint32Array };
}

/** What is drawn, and how. */
export interface Display {
  cloud: boolean;
  mesh: boolean;
  wireframe: boolean;
  /** A point's width in pixels of the depth map, as far away as the point is: with 1 there are no gaps. */
  pointSize: number;
  theme: "light" | "dark";
  /** How opaque the meshes are, 0 to 1; 1 by default. */
  meshOpacity?: number | undefined;
}

/** Where from: exactly the depth camera, or beside it, above it, at its right. */
export type Look = "camera" | "orbit" | "top" | "side";

/** What the gizmo changes. */
export type GizmoMode = "translate" | "rotate" | "scale";

/** A pose that another one moves to. */
export interface Animation {
  from: Matrix;
  durationMs: number;
}

/** What the page is told. */
export interface ViewEvents {
  /** The gizmo moves an object, or has been let go. */
  onPose(id: string, pose: Float64Array, phase: "drag" | "end"): void;
  /** A mesh, or the points of a mask, or neither were clicked. */
  onSelect(id: string | null): void;
  /** The depth map's pixel under the pointer. */
  onHover?(pixel: { x: number; y: number } | null): void;
}

/** How a view is made. */
export interface ViewOptions {
  /** WebGL 2 even where there is WebGPU. */
  forceWebGL?: boolean | undefined;
}

/** A view of a scene and of meshes in it. */
export interface View {
  readonly backend: "webgpu" | "webgl";
  /** Replaces the cloud, and the objects' highlights with it; looks at it from the camera's place. */
  setScene(scene: SceneInput): void;
  /**
   * Replaces all objects; those whose id is known keep their pose. Rejects where a GLB can't be read; the objects are
   * then as they were.
   */
  setObjects(objects: ObjectInput[]): Promise<void>;
  /**
   * Puts a mesh somewhere, or hides it (null); resolves when it is there. Where the user prefers less motion, there is
   * no animation.
   */
  setPose(id: string, pose: Matrix | null, animate?: Animation): Promise<void>;
  select(id: string | null): void;
  /** For the selected mesh; null takes the gizmo away. */
  setGizmo(mode: GizmoMode | null): void;
  setDisplay(display: Display): void;
  lookFrom(which: Look): void;
  /** Turns about this point of the camera frame (OpenCV, metres) from now on; the selected object's centre by default. */
  focus(point?: [number, number, number]): void;
  /** A ring about a point of the camera frame (OpenCV, metres), or none. */
  mark(point: [number, number, number] | null): void;
  /** A PNG of what is seen. */
  snapshot(): Promise<Blob>;
  dispose(): void;
}
