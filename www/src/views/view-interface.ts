export type Matrix = ArrayLike<number>;
export interface SceneInput {
  depthM: Float32Array;
  width: number;
  height: number;
  camera: { fx: number; fy: number; cx: number; cy: number };
  rgba?: Uint8ClampedArray;
}
export interface ObjectInput {
  id: string;
  colour: string;
  mask: Uint8Array;
  mesh: { glb: Uint8Array } | { positions: Float32Array; indices: Uint32Array };
}
export interface View {
  readonly backend: "webgpu" | "webgl";
  setScene(scene: SceneInput): void;
  setObjects(objects: ObjectInput[]): Promise<void>;
  setPose(id: string, pose: Matrix | null, animate?: { from: Matrix; durationMs: number }): Promise<void>;
  select(id: string | null): void;
  setGizmo(mode: "translate" | "rotate" | "scale" | null): void;
  setDisplay(display: {
    cloud: boolean;
    mesh: boolean;
    wireframe: boolean;
    pointSize: number;
    theme: "light" | "dark";
  }): void;
  lookFrom(which: "camera" | "orbit" | "top" | "side"): void;
  focus(point?: [number, number, number]): void;
  snapshot(): Promise<Blob>;
  dispose(): void;
}
