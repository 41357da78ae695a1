/** What is used of three.js' classes: anything of this shape will do, of whatever version or build. */

/** `Vector3`, as far as it is set. */
export interface Vector3Like {
  set(x: number, y: number, z: number): unknown;
}

/** `Quaternion`, as far as it is set. */
export interface QuaternionLike {
  set(x: number, y: number, z: number, w: number): unknown;
}

/** `Matrix4`: 16 numbers, column by column. */
export interface Matrix4Like {
  readonly elements: ArrayLike<number>;
}

/** `Object3D`, as far as it is posed. */
export interface PosableObject {
  readonly position: Vector3Like;
  readonly quaternion: QuaternionLike;
  readonly scale: Vector3Like;
  readonly matrix: Matrix4Like;
  readonly matrixWorld: Matrix4Like;
  updateMatrix(): void;
  updateWorldMatrix(updateParents: boolean, updateChildren: boolean): void;
}

/** A camera, or anything else that frames are taken from. */
export interface PlacedObject {
  readonly matrixWorld: Matrix4Like;
  updateWorldMatrix(updateParents: boolean, updateChildren: boolean): void;
}

/** `BufferAttribute` and `InterleavedBufferAttribute`. */
export interface AttributeLike {
  readonly count: number;
  getX(index: number): number;
  getY(index: number): number;
  getZ(index: number): number;
}

/** `BufferGeometry`. */
export interface GeometryLike {
  readonly attributes: { readonly [name: string]: unknown };
  readonly index: { readonly count: number; getX(index: number): number } | null;
}

/** `Object3D`, as far as its meshes are read. */
export interface MeshTree extends PlacedObject {
  traverse(callback: (object: PlacedObject) => void): void;
}

/** `PerspectiveCamera`, as far as its lens is set. */
export interface PerspectiveCameraLike {
  fov: number;
  aspect: number;
  near: number;
  far: number;
  zoom: number;
  filmOffset: number;
  setViewOffset(fullWidth: number, fullHeight: number, x: number, y: number, width: number, height: number): void;
  updateProjectionMatrix(): void;
}
