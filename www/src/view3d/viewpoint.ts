/** The viewpoint: exactly the depth camera, or an orbit around a target. */
import { applyPinhole } from "sim3align/three";
import { boxOf } from "../pictures/box.js";
import type { Model } from "./model.js";
import { DirectionalLight, OrbitControls, PerspectiveCamera, Quaternion, Spherical, Vector3 } from "./three.js";
import type { Look, ObjectInput, SceneInput } from "./types.js";

/** Viewpoints as angles from the depth camera in degrees: to the right, and up. */
const directions: Record<Exclude<Look, "camera">, [number, number]> = { orbit: [28, 16], top: [0, 80], side: [82, 8] };
/** The same where the ground is known: exactly along its axes, from the depth camera's side. */
const onGround = { ...directions, top: [0, 90], side: [90, 0] } satisfies typeof directions;
/** Share of the smaller side of the view that the target fills. */
const fill = 0.8;

/** How far a key turns the view, degrees, and the factor by which it changes the distance. */
const [KEY_DEG, KEY_ZOOM] = [6, 1.15];

/** What keys of the canvas do: arrows orbit, plus and minus come nearer and go away. */
const keys: Readonly<Record<string, readonly [rightDeg: number, upDeg: number, factor: number]>> = {
  ArrowLeft: [-KEY_DEG, 0, 1],
  ArrowRight: [KEY_DEG, 0, 1],
  ArrowUp: [0, KEY_DEG, 1],
  ArrowDown: [0, -KEY_DEG, 1],
  "+": [0, 0, 1 / KEY_ZOOM],
  "-": [0, 0, KEY_ZOOM],
};

/** A part of the image, in pixels. */
export interface Rect {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Share of the view that the objects fill in the view from the depth camera. */
const CROP_FILL = 0.72;

/** Wider lenses would show a target from very near. */
const MAX_HALF_FOV_DEG = 35;

/** The camera and its controls, in the frame of three.js: x right, y up, z towards the camera. */
export class Viewpoint {
  readonly camera = new PerspectiveCamera(45, 1, 0.01, 100);
  readonly controls: OrbitControls;
  /** Whether the view is exactly that of the depth camera. */
  isCamera = false;
  /** Whether the user moved the camera since the last `lookFrom`. */
  isTouched = false;
  /** Whether the image fills the view, so that a part of it is out of sight. */
  fillsView = false;
  /** Whether the user started to move the camera since the last `lookFrom`. */
  private isHeld = false;
  private scene: SceneInput | null = null;
  /** The part of the image that fills the view; `null` is all of it. */
  private crop: Rect | null = null;
  private target: Vector3 | null = null;
  /** The ground's normal in the frame of three.js; up in the image without one. */
  private up = new Vector3(0, 1, 0);
  private hasGround = false;
  /** From the axis of the orbit to y. */
  private readonly turn = new Quaternion();
  private size = { width: 1, height: 1 };
  private readonly lens = { near: 0.01, far: 100 };

  constructor(
    canvas: HTMLCanvasElement,
    private readonly onChange: () => void,
  ) {
    // The light moves with the camera.
    const lamp = new DirectionalLight(0xffffff, 1.2);
    lamp.position.set(-0.4, 1, 0.8);
    this.camera.add(lamp, lamp.target);
    this.controls = new OrbitControls(this.camera, canvas);
    this.listenToKeys(canvas);
    this.controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.controls.dampingFactor = 0.12;
    this.controls.addEventListener("start", () => {
      this.isHeld = true;
    });
    this.controls.addEventListener("change", () => {
      // A click alone moves nothing, and damping continues after the release.
      if (this.isHeld && this.isCamera) this.leaveCamera();
      this.isTouched ||= this.isHeld;
      onChange();
    });
  }

  /** Listens to a canvas, for as long as it exists. */
  private listenToKeys(canvas: HTMLCanvasElement): void {
    canvas.tabIndex = 0;
    canvas.addEventListener("keydown", (event) => {
      const turn = keys[event.key];
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || turn === undefined) return;
      event.preventDefault();
      this.orbit(...turn);
      this.onChange();
    });
  }

  /** Sets the scene, whose depths range from `near` to `far`, metres. */
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
   * Uses the intrinsics of the depth camera for all viewpoints, so that orbiting away from it starts smoothly. If the
   * aspect ratio of the canvas differs, it shows more than the image on two sides.
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
    const { left, top, right, bottom } = this.crop ?? { left: 0, top: 0, right: image.width, bottom: image.height };
    const fill = this.crop === null ? 1 : CROP_FILL;
    // No more than the image is shown at once.
    const least = Math[this.fillsView ? "max" : "min"](width / image.width, height / image.height);
    const scale = Math.max(least, fill / Math.max((right - left) / width, (bottom - top) / height, 1e-6));
    const [visibleWidth, visibleHeight] = [width / scale, height / scale];
    const centre = (low: number, high: number, visible: number, all: number) => {
      const start = (low + high - visible) / 2;
      return visible >= all ? (all - visible) / 2 : Math.min(Math.max(start, 0), all - visible);
    };
    const x = view.offsetX + centre(left, right, visibleWidth, image.width);
    const y = view.offsetY + centre(top, bottom, visibleHeight, image.height);
    this.camera.setViewOffset(image.width, image.height, x, y, visibleWidth, visibleHeight);
    // setViewOffset resets the aspect to that of square pixels.
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }

  /** The field of view of the smaller side of the canvas, degrees. */
  private get fovDeg(): number {
    const { width, height } = this.size;
    const { elements } = this.camera.projectionMatrix;
    const half = Math.atan(1 / (width < height ? (elements[0] ?? 1) : (elements[5] ?? 1)));
    return (360 / Math.PI) * half;
  }

  /** Lets the viewpoint come close to what has this radius, however far the rest of the scene is. */
  private reach(radius: number): void {
    const near = Math.min(this.lens.near, 0.02 * radius);
    this.controls.minDistance = Math.min(this.controls.minDistance, 0.2 * radius);
    this.controls.maxDistance = Math.max(this.controls.maxDistance, 20 * radius);
    if (near === this.lens.near) return;
    this.lens.near = near;
    this.updateLens();
  }

  /** Looks at a target with a radius, in metres. */
  lookFrom(which: Look, target: Vector3, radius: number, crop: Rect | null = null): void {
    const { camera, controls } = this;
    this.crop = which === "camera" ? crop : null;
    this.target = target.clone();
    this.updateLens();
    // From the depth camera, the image is upright.
    this.orbitAbout(which === "camera" ? new Vector3(0, 1, 0) : this.up);
    // Ends the damping of the last movement.
    const isDamped = controls.enableDamping;
    controls.enableDamping = false;
    controls.update();
    if (which === "camera") {
      camera.position.set(0, 0, 0);
      // On the optical axis, because the controls point the camera at the target.
      controls.target.set(0, 0, Math.min(target.z, -this.lens.near));
    } else {
      const [right, up] = (this.hasGround ? onGround : directions)[which].map((angle) => (angle * Math.PI) / 180) as [
        number,
        number,
      ];
      const distance = radius / (fill * Math.sin((Math.PI / 360) * Math.min(this.fovDeg, 2 * MAX_HALF_FOV_DEG)));
      this.reach(radius);
      const away = this.awayFrom(target, new Vector3());
      // Above the depth camera, or above the ground.
      const isLevel = this.hasGround && which !== "orbit";
      const phi = Math.max(isLevel ? 0.01 : 0.08, (isLevel ? Math.PI / 2 : away.phi) - up);
      this.moveTo(target, new Spherical(distance, phi, away.theta + right));
      controls.target.copy(target);
    }
    controls.update();
    controls.enableDamping = isDamped;
    this.isHeld = false;
    this.isTouched = false;
    this.isCamera = which === "camera";
  }

  /** Turns the view from the depth camera into an orbit about the objects, which stay where they are in the view. */
  private leaveCamera(): void {
    this.isCamera = false;
    if (this.crop === null || this.target === null || this.scene === null) return;
    const { cx, cy } = this.scene.camera;
    const [halfWidth, halfHeight] = [(this.crop.right - this.crop.left) / 2, (this.crop.bottom - this.crop.top) / 2];
    this.crop = { left: cx - halfWidth, right: cx + halfWidth, top: cy - halfHeight, bottom: cy + halfHeight };
    this.controls.target.copy(this.target);
    this.camera.lookAt(this.target);
    this.updateLens();
  }

  /** Orbits by angles in degrees, and changes the distance by a factor. */
  private orbit(rightDeg: number, upDeg: number, factor: number): void {
    if (this.isCamera) this.leaveCamera();
    this.isTouched = true;
    const { camera, controls } = this;
    const away = this.awayFrom(controls.target, camera.position);
    away.theta += (rightDeg * Math.PI) / 180;
    away.phi = Math.min(Math.max(away.phi - (upDeg * Math.PI) / 180, 0.02), Math.PI - 0.02);
    away.radius *= factor;
    this.moveTo(controls.target, away);
    controls.update();
  }

  /** Sets the ground's normal, which views from above and from the side have upwards; null is up in the image. */
  setUp(normal: Vector3 | null): void {
    this.hasGround = normal !== null;
    this.up = normal?.clone().normalize() ?? new Vector3(0, 1, 0);
  }

  private orbitAbout(up: Vector3): void {
    this.camera.up.copy(up);
    this.turn.setFromUnitVectors(up, new Vector3(0, 1, 0));
    // The controls read the axis once, when they are made.
    const axis = this.controls as unknown as { _quat: Quaternion; _quatInverse: Quaternion };
    axis._quat.copy(this.turn);
    axis._quatInverse.copy(this.turn).invert();
  }

  /** Where a place is from a target, by angles about the axis of the orbit. */
  private awayFrom(target: Vector3, place: Vector3): Spherical {
    return new Spherical().setFromVector3(place.clone().sub(target).applyQuaternion(this.turn));
  }

  private moveTo(target: Vector3, away: Spherical): void {
    const back = this.turn.clone().invert();
    this.camera.position.setFromSpherical(away).applyQuaternion(back).add(target);
  }

  /** Centres the view on a point and orbits around it. */
  focus(point: Vector3): void {
    if (this.isCamera) this.leaveCamera();
    this.isTouched = true;
    const { camera, controls } = this;
    camera.position.add(point).sub(controls.target);
    controls.target.copy(point);
    controls.update();
  }

  /** Switches to the new canvas after a graphics device was lost. */
  connect(canvas: HTMLCanvasElement): void {
    this.controls.disconnect();
    this.controls.connect(canvas);
    this.listenToKeys(canvas);
  }

  dispose(): void {
    this.controls.dispose();
  }
}

const lookNames: Record<Look, string> = {
  camera: "the depth camera",
  orbit: "three quarters",
  top: "above",
  side: "the side",
};

/**
 * What the view shows.
 *
 * @param points the number of points of the scene
 * @param placed the names of the meshes that have a pose
 */
export function description(from: Look, points: number, placed: readonly string[]): string {
  const meshes = placed.length === 0 ? "no mesh placed yet" : `placed meshes: ${placed.join(", ")}`;
  return `3D view from ${lookNames[from]}: ${points.toLocaleString("en-GB")} points of the scene, ${meshes}`;
}

/** The smallest rectangle that shows all masks and all meshes; `null` if there are none. */
export function cropOf(
  { width, camera }: SceneInput,
  objects: readonly ObjectInput[],
  models: ReadonlyMap<string, Model>,
): Rect | null {
  const rect = { left: Number.POSITIVE_INFINITY, top: Number.POSITIVE_INFINITY, right: -1, bottom: -1 };
  const add = (u: number, v: number) => {
    [rect.left, rect.right] = [Math.min(rect.left, u), Math.max(rect.right, u)];
    [rect.top, rect.bottom] = [Math.min(rect.top, v), Math.max(rect.bottom, v)];
  };
  for (const { id, mask } of objects) {
    const box = boxOf(mask, width);
    if (box !== null) {
      add(box.left, box.top);
      add(box.right - 1, box.bottom - 1);
    }
    for (const { x, y, z } of models.get(id)?.corners() ?? []) {
      if (z > 0) add((camera.fx * x) / z + camera.cx, (camera.fy * y) / z + camera.cy);
    }
  }
  return rect.right < 0 ? null : rect;
}
