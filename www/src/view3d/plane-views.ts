/** Small views from above, from the side and from the front, in which the selected object is moved and turned. */
import type { Quaternion } from "three/webgpu";
import type { Model } from "./model.js";
import type { Stage } from "./stage.js";
import { OrthographicCamera, Vector3 } from "./three.js";
import type { PlaneInput } from "./types.js";

/** The views: what they show rightwards, upwards and towards the viewer, as signed axes 1 to 3: right, up, to the camera. */
const views = [
  { name: "Top", axes: [1, -3, 2] },
  { name: "Side", axes: [-3, 2, 1] },
  { name: "Front", axes: [1, 2, 3] },
] as const;

/** The colours of the axes: those of the handles in the large view. */
const axisColours = ["#e5484d", "#30a46c", "#3e7bfa"];

/** The share of the width that the views take. */
export const SHARE = 0.27;

/** Half the height of a view, as a multiple of the object's radius. */
const MARGIN = 1.3;

/** Of half the smaller side of a view: the ring, and the arrows inside it. */
const [RING, ARROW] = [0.86, 0.6];

/** How far from a handle it is grabbed, CSS pixels. */
const REACH_PX = 12;

/** What a handle does: moves along the horizontal or the vertical of the view, or both, or turns. */
type Handle = "x" | "y" | "free" | "turn";

/** What the views need of the 3D view. */
interface Surface {
  readonly stage: Stage;
  /** The object that is dragged. */
  model(): Model | null;
  /** The ground, whose normal is up; `null` takes the camera's. */
  plane(): PlaneInput | null;
  /** Runs with what the small views show: no handles, labels and lines. */
  undecorated(draw: () => void): void;
  onPose(model: Model, phase: "drag" | "end"): void;
}

export class PlaneViews {
  private readonly column = document.createElement("div");
  private readonly views;
  /** What is in the middle, and how large it is; both stay during a drag. */
  private focus: { centre: Vector3; radius: number } | null = null;
  private shown = "";

  constructor(
    host: HTMLElement,
    private readonly surface: Surface,
  ) {
    this.column.style.cssText = `position:absolute;inset:0 0 0 auto;width:${100 * SHARE}%;display:flex;flex-direction:column;gap:1px`;
    this.views = views.map(({ name, axes }) => new PlaneView(name, axes, surface));
    this.column.append(...this.views.map(({ canvas }) => canvas));
    host.append(this.column);
  }

  /** Draws what has changed; `state` is what the views show beside the poses. */
  draw(state: string): void {
    const model = this.surface.model();
    const corners = model?.corners() ?? null;
    const isHeld = this.views.some((view) => view.isHeld);
    if (!isHeld || this.focus === null) {
      this.focus = null;
      if (model !== null && corners !== null) {
        const centre = (corners[0] as Vector3).clone().lerp(corners[7] as Vector3, 0.5);
        this.focus = { centre: toThree(centre), radius: model.radius * model.pivot.scale.x };
      }
    }
    const { clientWidth, clientHeight } = this.column;
    const key = [state, clientWidth, clientHeight, corners?.map((corner) => corner.toArray().join()).join()].join();
    if (key === this.shown) return;
    this.shown = key;
    const middle = corners && toThree((corners[0] as Vector3).clone().lerp(corners[7] as Vector3, 0.5));
    this.surface.undecorated(() => {
      for (const view of this.views) view.draw(this.focus, middle);
    });
  }

  dispose(): void {
    this.column.remove();
  }
}

/** One of the views. */
class PlaneView {
  readonly canvas = document.createElement("canvas");
  private readonly camera = new OrthographicCamera();
  /** Unit vectors in the frame of three.js. */
  private right = new Vector3();
  private up = new Vector3();
  private towards = new Vector3();
  private pxPerM = 1;
  /** Where the middle of the object is, CSS pixels. */
  private at = { x: 0, y: 0 };
  private held: {
    model: Model;
    handle: Handle;
    from: Pointer;
    position: Vector3;
    turn: Quaternion;
    moved: boolean;
  } | null = null;

  constructor(
    private readonly name: string,
    private readonly axes: readonly [number, number, number],
    private readonly surface: Surface,
  ) {
    this.canvas.style.cssText = "display:block;width:100%;flex:1;min-height:0;touch-action:none";
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `${name} view of the selected object, to be dragged`);
    this.canvas.dataset.plane = name.toLowerCase();
    this.canvas.addEventListener("pointerdown", (event) => this.grab(event));
    this.canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"] as const) this.canvas.addEventListener(end, () => this.release());
  }

  get isHeld(): boolean {
    return this.held !== null;
  }

  /** Draws the scene around a focus, and handles at the middle of the object. */
  draw(focus: { centre: Vector3; radius: number } | null, middle: Vector3 | null): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const context = this.canvas.getContext("2d");
    if (context === null || width === 0 || height === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.round(width * ratio)) this.canvas.width = Math.round(width * ratio);
    if (this.canvas.height !== Math.round(height * ratio)) this.canvas.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    if (focus !== null && middle !== null) {
      this.turnTo(this.surface.plane());
      const reach = MARGIN * focus.radius;
      this.pxPerM = Math.min(width, height) / (2 * reach);
      this.aim(focus.centre, focus.radius);
      this.surface.stage.copy(this.camera, context, { width, height, pxPerM: this.pxPerM });
      const off = middle.clone().sub(focus.centre);
      this.at = { x: width / 2 + off.dot(this.right) * this.pxPerM, y: height / 2 - off.dot(this.up) * this.pxPerM };
      this.drawHandles(context);
    }
    context.font = "600 12px system-ui, sans-serif";
    context.textBaseline = "top";
    context.fillStyle = "rgb(16 20 26 / 82%)";
    context.fillRect(0, 0, context.measureText(this.name).width + 12, 20);
    context.fillStyle = "#ffffff";
    context.fillText(this.name, 6, 4);
  }

  /** Sets the axes of the view: up along the ground's normal, to the camera as far as that allows. */
  private turnTo(plane: PlaneInput | null): void {
    const up = plane === null ? new Vector3(0, 1, 0) : toThree(new Vector3(...plane.normal)).normalize();
    const toCamera = new Vector3(0, 0, 1).addScaledVector(up, -up.z);
    // Seen from straight above, the top of the image is away.
    if (toCamera.length() < 0.05) toCamera.set(0, -1, 0).addScaledVector(up, up.y);
    toCamera.normalize();
    const all = [new Vector3().crossVectors(up, toCamera), up, toCamera];
    const [right, upwards, towards] = this.axes.map((axis) =>
      (all[Math.abs(axis) - 1] as Vector3).clone().multiplyScalar(Math.sign(axis)),
    ) as [Vector3, Vector3, Vector3];
    Object.assign(this, { right, up: upwards, towards });
  }

  /** Looks at what is around the object only, so that nothing in front hides it. */
  private aim(centre: Vector3, radius: number): void {
    const { camera } = this;
    const distance = 8 * radius;
    camera.up.copy(this.up);
    camera.position.copy(centre).addScaledVector(this.towards, distance);
    camera.lookAt(centre);
    camera.near = distance - 1.6 * radius;
    camera.far = distance + 3 * radius;
  }

  private get ringPx(): number {
    return (RING * Math.min(this.canvas.clientWidth, this.canvas.clientHeight)) / 2;
  }

  private drawHandles(context: CanvasRenderingContext2D): void {
    const { x, y } = this.at;
    const [ring, arrow] = [this.ringPx, ARROW * this.ringPx];
    const colourOf = (k: number) => axisColours[Math.abs(this.axes[k] as number) - 1] as string;
    context.lineWidth = 2;
    context.strokeStyle = colourOf(2);
    context.beginPath();
    context.arc(x, y, ring, 0, 2 * Math.PI);
    context.stroke();
    for (const [k, dx, dy] of [
      [0, 1, 0],
      [1, 0, -1],
    ] as const) {
      context.strokeStyle = colourOf(k);
      context.fillStyle = colourOf(k);
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + arrow * dx, y + arrow * dy);
      context.stroke();
      context.beginPath();
      const tip = [x + (arrow + 8) * dx, y + (arrow + 8) * dy] as const;
      context.moveTo(...tip);
      context.lineTo(tip[0] - 9 * dx + 5 * dy, tip[1] - 9 * dy + 5 * dx);
      context.lineTo(tip[0] - 9 * dx - 5 * dy, tip[1] - 9 * dy - 5 * dx);
      context.fill();
    }
  }

  private handleAt({ x, y }: Pointer): Handle | null {
    const [dx, dy] = [x - this.at.x, y - this.at.y];
    const distance = Math.hypot(dx, dy);
    const arrow = ARROW * this.ringPx + REACH_PX;
    if (Math.abs(distance - this.ringPx) <= REACH_PX) return "turn";
    if (distance > this.ringPx) return null;
    if (Math.abs(dy) <= REACH_PX && dx > REACH_PX && dx <= arrow) return "x";
    if (Math.abs(dx) <= REACH_PX && dy < -REACH_PX && dy >= -arrow) return "y";
    return "free";
  }

  private grab(event: PointerEvent): void {
    const [model, from] = [this.surface.model(), placeOf(event)];
    const handle = this.handleAt(from);
    if (model === null || handle === null || event.button !== 0 || this.held !== null) return;
    this.canvas.setPointerCapture(event.pointerId);
    const { position, quaternion } = model.pivot;
    this.held = { model, handle, from, position: position.clone(), turn: quaternion.clone(), moved: false };
  }

  private drag(event: PointerEvent): void {
    const to = placeOf(event);
    if (this.held === null) {
      const handle = this.handleAt(to);
      this.canvas.style.cursor = handle === null ? "" : handle === "turn" ? "grab" : "move";
      return;
    }
    const { model, handle, from, position, turn } = this.held;
    this.held.moved = true;
    if (handle === "turn") {
      // The ring stays where it is.
      const angle = ({ x, y }: Pointer) => Math.atan2(this.at.y - y, x - this.at.x);
      const axis = toThree(this.towards.clone());
      model.pivot.quaternion.setFromAxisAngle(axis, angle(to) - angle(from)).multiply(turn);
    } else {
      const moved = new Vector3();
      if (handle !== "y") moved.addScaledVector(this.right, (to.x - from.x) / this.pxPerM);
      if (handle !== "x") moved.addScaledVector(this.up, (from.y - to.y) / this.pxPerM);
      model.pivot.position.copy(position).add(toThree(moved));
    }
    this.surface.onPose(model, "drag");
  }

  private release(): void {
    const { held } = this;
    this.held = null;
    if (held?.moved) this.surface.onPose(held.model, "end");
  }
}

interface Pointer {
  x: number;
  y: number;
}

const placeOf = ({ offsetX: x, offsetY: y }: PointerEvent): Pointer => ({ x, y });

/** A vector of the OpenCV camera frame in the frame of three.js, or the other way round; changes the vector. */
const toThree = (vector: Vector3) => vector.set(vector.x, -vector.y, -vector.z);
