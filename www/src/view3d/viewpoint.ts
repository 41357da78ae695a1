/** Where the view is seen from: exactly the depth camera, or anywhere about a target. */
import { applyPinhole } from "sim3align/three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { PerspectiveCamera, Spherical, type Vector3 } from "three/webgpu";
import type { Look, SceneInput } from "./types.js";

/** Directions to look from, as angles from the camera's own, in degrees: to the right, and up. */
const directions: Record<Exclude<Look, "camera">, [number, number]> = { orbit: [28, 16], top: [0, 80], side: [82, 8] };
/** How much of the view's smaller side the target takes, seen from above or from the side. */
const fill = 0.55;

/** The camera, and the controls that move it. In three.js' terms: x right, y up, z towards the camera. */
export class Viewpoint {
  readonly camera = new PerspectiveCamera(45, 1, 0.01, 100);
  readonly controls: OrbitControls;
  /** Whether the depth camera's picture is what is seen. */
  isCamera = false;
  /** Whether somebody has moved it since the last look. */
  isTouched = false;
  /** Whether somebody has taken hold of it since the last look. */
  private isHeld = false;
  private scene: SceneInput | null = null;
  private size = { width: 1, height: 1 };
  private readonly lens = { near: 0.01, far: 100 };

  constructor(canvas: HTMLCanvasElement, onChange: () => void) {
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.controls.dampingFactor = 0.12;
    this.controls.addEventListener("start", () => {
      this.isHeld = true;
    });
    this.controls.addEventListener("change", () => {
      // A click alone moves nothing; what has been let go may go on turning.
      if (this.isHeld) this.isCamera = false;
      this.isTouched ||= this.isHeld;
      onChange();
    });
  }

  /** Another scene, that reaches from `near` to `far`, metres. */
  setScene(scene: SceneInput, near: number, far: number): void {
    this.scene = scene;
    this.lens.near = Math.max(1e-4, 0.02 * near);
    this.lens.far = 40 * far;
    this.controls.minDistance = 0.04 * near;
    this.controls.maxDistance = 12 * far;
    this.updateLens();
  }

  resize(width: number, height: number): void {
    this.size = { width, height };
    this.updateLens();
  }

  /**
   * The depth camera's lens for all looks, so that nothing jumps when somebody turns away from its view. Where the canvas
   * has other proportions, it shows more than the image at two sides.
   */
  private updateLens(): void {
    const { width, height } = this.size;
    if (!this.scene) {
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      return;
    }
    const image = { width: this.scene.width, height: this.scene.height };
    applyPinhole(this.camera, this.scene.camera, { ...image, ...this.lens });
    const { aspect, view } = this.camera;
    if (!view) return;
    const scale = Math.min(width / image.width, height / image.height);
    const [seenWidth, seenHeight] = [width / scale, height / scale];
    const x = view.offsetX - (seenWidth - image.width) / 2;
    const y = view.offsetY - (seenHeight - image.height) / 2;
    this.camera.setViewOffset(image.width, image.height, x, y, seenWidth, seenHeight);
    // That has set the aspect for square pixels.
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }

  /** Looks at a target of a radius, metres. */
  lookFrom(which: Look, target: Vector3, radius: number): void {
    const { camera, controls } = this;
    camera.up.set(0, 1, 0);
    // What is left of the last movement must not go on.
    const isDamped = controls.enableDamping;
    controls.enableDamping = false;
    controls.update();
    if (which === "camera") {
      camera.position.set(0, 0, 0);
      // On the optical axis: the controls turn the camera towards its target.
      controls.target.set(0, 0, Math.min(target.z, -this.lens.near));
    } else {
      const [right, up] = directions[which].map((angle) => (angle * Math.PI) / 180) as [number, number];
      const near = radius / (fill * Math.tan((Math.PI / 360) * camera.fov));
      const distance = which === "orbit" ? target.length() : Math.min(target.length(), near);
      const away = new Spherical().setFromVector3(target.clone().negate());
      const phi = Math.max(0.08, away.phi - up);
      camera.position.setFromSphericalCoords(distance, phi, away.theta + right).add(target);
      controls.target.copy(target);
    }
    controls.update();
    controls.enableDamping = isDamped;
    this.isHeld = false;
    this.isTouched = false;
    this.isCamera = which === "camera";
  }

  /** Turns about another point from now on, which comes to the middle. */
  focus(point: Vector3): void {
    this.isCamera = false;
    this.isTouched = true;
    const { camera, controls } = this;
    camera.position.add(point).sub(controls.target);
    controls.target.copy(point);
    controls.update();
  }

  /** Another canvas, after the graphics device has been lost. */
  connect(canvas: HTMLCanvasElement): void {
    this.controls.disconnect();
    this.controls.connect(canvas);
  }

  dispose(): void {
    this.controls.dispose();
  }
}
