/** The gizmo: handles that move, rotate or scale a model. */

import type { PerspectiveCamera, Scene, Vector3 } from "three/webgpu";
import type { Model } from "./model.js";
import { TransformControls } from "./three.js";
import type { GizmoMode, GizmoSettings } from "./types.js";

/** Largest scale factor of one drag, up or down, so that a slip does not lose the mesh. */
const maxFactor = 20;

/** Steps of rotations, and of movements as a share of the object's size. */
const [STEP_DEG, STEP_SHARE] = [5, 0.01];

/** Events of a gizmo. */
export interface GizmoEvents {
  /** The gizmo needs to be drawn again. */
  onChange(): void;
  /** A handle is grabbed or released. In between, other controls must ignore the pointer. */
  onHold(isHeld: boolean): void;
  onPose(model: Model, phase: "drag" | "end"): void;
}

/** Handles at the centre of a model. */
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

  /** Whether the pointer hovers over or holds a handle. */
  get isBusy(): boolean {
    return this.model !== null && (this.controls.dragging || this.controls.axis !== null);
  }

  /** Sets the model, the function of the handles, and their axes and steps. `null` hides them. */
  set(model: Model | null, mode: GizmoMode | null, { isLocal, snaps }: GizmoSettings): void {
    const next = mode !== null && model?.pivot.visible ? model : null;
    if (next !== this.model && this.controls.dragging) this.controls.pointerUp(null);
    this.model = next;
    this.mode = mode;
    if (mode !== null) this.controls.setMode(mode);
    if (next) this.controls.attach(next.pivot);
    else this.controls.detach();
    this.controls.setSpace(isLocal ? "local" : "world");
    this.controls.setRotationSnap(snaps ? (STEP_DEG * Math.PI) / 180 : null);
    const size = this.model === null ? 0 : 2 * this.model.radius * this.model.pivot.scale.x;
    this.controls.setTranslationSnap(snaps && size > 0 ? STEP_SHARE * size : null);
    this.controls.setScaleSnap(snaps ? STEP_SHARE : null);
    this.events.onChange();
  }

  /** The handles as drawn. */
  get object() {
    return this.controls.getHelper();
  }

  /** Switches to the new canvas after a graphics device was lost. */
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

/** Makes the scale uniform, as a similarity requires: the dragged handle determines it. */
export function makeUniform(scale: Vector3, start: number): void {
  const ratios = scale.toArray().map((length) => length / start);
  const factor = ratios.reduce((most, ratio) => (Math.abs(ratio - 1) > Math.abs(most - 1) ? ratio : most), 1);
  scale.setScalar(start * Math.min(maxFactor, Math.max(1 / maxFactor, factor)));
}
