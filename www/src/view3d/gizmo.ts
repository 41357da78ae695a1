/** The gizmo: moves, turns or scales a model by handles. */
import { TransformControls } from "three/addons/controls/TransformControls.js";
import type { PerspectiveCamera, Scene, Vector3 } from "three/webgpu";
import type { Model } from "./model.js";
import type { GizmoMode } from "./types.js";

/** Nothing is scaled by more than this, either way, in one drag: a slip must not lose the mesh. */
const mostAtOnce = 20;

/** What a gizmo tells. */
export interface GizmoEvents {
  /** Something looks different. */
  onChange(): void;
  /** A handle has been taken, or let go: meanwhile nothing else may follow the pointer. */
  onHold(isHeld: boolean): void;
  onPose(model: Model, phase: "drag" | "end"): void;
}

/** Handles at a model's centre. */
export class Gizmo {
  private readonly controls: TransformControls;
  private model: Model | null = null;
  private mode: GizmoMode | null = null;
  private startScale = 1;
  private hasMoved = false;

  constructor(
    private readonly scene: Scene,
    camera: PerspectiveCamera,
    canvas: HTMLCanvasElement,
    private readonly events: GizmoEvents,
  ) {
    this.controls = new TransformControls(camera, canvas);
    this.controls.setSize(0.9);
    this.scene.add(this.controls.getHelper());
    this.controls.addEventListener("change", events.onChange);
    this.controls.addEventListener("dragging-changed", ({ value }) => this.hold(value === true));
    this.controls.addEventListener("objectChange", () => this.drag());
  }

  /** Whether the pointer is on a handle, or has taken it. */
  get isBusy(): boolean {
    return this.model !== null && (this.controls.dragging || this.controls.axis !== null);
  }

  /** Which model, and what the handles do; null takes them away. */
  set(model: Model | null, mode: GizmoMode | null): void {
    const wanted = mode !== null && model?.pivot.visible ? model : null;
    if (wanted !== this.model && this.controls.dragging) this.controls.pointerUp(null);
    this.model = wanted;
    this.mode = mode;
    if (mode !== null) this.controls.setMode(mode);
    if (wanted) this.controls.attach(wanted.pivot);
    else this.controls.detach();
    this.events.onChange();
  }

  /** Another canvas, after the graphics device has been lost. */
  connect(canvas: HTMLCanvasElement): void {
    this.controls.disconnect();
    this.controls.connect(canvas);
  }

  private hold(isHeld: boolean): void {
    this.events.onHold(isHeld);
    if (!this.model) return;
    if (isHeld) {
      this.startScale = this.model.pivot.scale.x;
      this.hasMoved = false;
    } else if (this.hasMoved) this.events.onPose(this.model, "end");
  }

  private drag(): void {
    if (!this.model) return;
    if (this.mode === "scale") makeUniform(this.model.pivot.scale, this.startScale);
    this.hasMoved = true;
    this.events.onPose(this.model, "drag");
  }

  dispose(): void {
    this.controls.detach();
    this.controls.getHelper().removeFromParent();
    this.controls.dispose();
  }
}

/** A similarity scales alike along all axes: by what the dragged handle says. */
export function makeUniform(scale: Vector3, start: number): void {
  const ratios = scale.toArray().map((length) => length / start);
  const farthest = ratios.reduce((far, ratio) => (Math.abs(ratio - 1) > Math.abs(far - 1) ? ratio : far), 1);
  scale.setScalar(start * Math.min(mostAtOnce, Math.max(1 / mostAtOnce, farthest)));
}
