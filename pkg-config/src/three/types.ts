/** The parts of three.js classes that this module uses. Any object of these shapes works. */

/** An object whose properties are not known. */
export type Fields = Record<string, unknown>;

export const isObject = (value: unknown): value is Fields => typeof value === "object" && value !== null;

/** A camera, or any other object whose world matrix is read. */
export interface PlacedObject {
  readonly matrixWorld: { readonly elements: ArrayLike<number> };
  updateWorldMatrix(updateParents: boolean, updateChildren: boolean): void;
}

/** An `Object3D` with a writable pose. */
export interface PosableObject extends PlacedObject {
  readonly position: { set(x: number, y: number, z: number): unknown };
  readonly quaternion: { set(x: number, y: number, z: number, w: number): unknown };
  readonly scale: { set(x: number, y: number, z: number): unknown };
  readonly matrix: { readonly elements: ArrayLike<number> };
  updateMatrix(): void;
}

/** A `BufferAttribute` or an `InterleavedBufferAttribute`. */
export interface AttributeLike {
  readonly count: number;
  getX(index: number): number;
  getY(index: number): number;
  getZ(index: number): number;
}

/** A range of the corners of triangles. */
export interface Range {
  readonly start: number;
  readonly count: number;
}

/** A `BufferGeometry`. */
export interface GeometryLike {
  readonly attributes: { readonly [name: string]: unknown };
  readonly index: { readonly count: number; getX(index: number): number } | null;
  readonly morphAttributes?: { readonly [name: string]: unknown };
  readonly drawRange?: Range;
  readonly groups?: readonly (Range & { readonly materialIndex?: number | undefined })[];
}

/** An `Object3D` whose meshes are read. */
export interface MeshTree extends PlacedObject {
  traverse(callback: (object: PlacedObject) => void): void;
}

/** A `PerspectiveCamera` with a writable projection. */
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
