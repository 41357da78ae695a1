/** The 3D view: point cloud, meshes, gizmo and viewpoint. */

import type { Colouring } from "../pictures/light.js";
import { Animations } from "./animations.js";
import { Cloud } from "./cloud.js";
import { Gizmo } from "./gizmo.js";
import { markOf } from "./label.js";
import { Model } from "./model.js";
import { release, whileHidden } from "./parts.js";
import { pick } from "./picker.js";
import { PlaneViews, SHARE } from "./plane-views.js";
import { Pointer } from "./pointer.js";
import { type Extent, extentOf, quantile, sortedDepths } from "./points.js";
import { eased } from "./pose.js";
import { Sizes } from "./sizes.js";
import { Stage } from "./stage.js";
import { colours, Surroundings } from "./surroundings.js";
import { Group, HemisphereLight, Sphere, Vector3 } from "./three.js";
import type {
  Animation,
  Display,
  GizmoMode,
  GizmoSettings,
  Look,
  Matrix,
  ObjectInput,
  PlaneInput,
  SceneInput,
  ViewEvents,
} from "./types.js";
import { cropOf, description, Viewpoint } from "./viewpoint.js";

/** Screens resolve no more points, and software renderers draw no more in acceptable time. */
const maxPoints = { hardware: 400_000, software: 80_000 };

/** How long the viewpoint takes to another extent. */
const GLIDE_MS = 700;

const isMotionReduced = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** A view of a scene with meshes. */
export class SceneView {
  /** Its children are in the OpenCV camera frame. In three.js, y is up and z points towards the camera. */
  private readonly root = new Group();
  private readonly viewpoint: Viewpoint;
  private readonly gizmo: Gizmo;
  private readonly mark = markOf();
  private plane: PlaneInput | null = null;
  private gizmoSettings: GizmoSettings = { isLocal: false, snaps: false };
  private readonly animations = new Animations();
  private readonly models = new Map<string, Model>();
  private readonly poses = new Map<string, Matrix>();
  private pointer: Pointer;
  private scene: SceneInput | null = null;
  private cloud: Cloud | null = null;
  private readonly surroundings = new Surroundings(this.root);
  private planes: PlaneViews | null = null;
  private readonly sizes = new Sizes(this.root);
  private objects: readonly ObjectInput[] = [];
  private selected: string | null = null;
  private gizmoMode: GizmoMode | null = null;
  private look: Look = "orbit";
  private fits = false;
  private loading = 0;
  /** What the viewpoint shows, and where it is on its way from and to. */
  private aimed: Extent = { centre: [0, 0, 1], radius: 0.5 };
  private glide: { from: Extent; to: Extent; started: number } | null = null;
  private display: Display = { cloud: true, mesh: true, wireframe: false, pointSize: 1.2, theme: "light" };

  /**
   * Creates a view that fills its host element.
   * @throws {NoGraphics} if the browser supports neither WebGPU nor WebGL 2
   */
  static async create(host: HTMLElement, events: ViewEvents, forceWebGL = false): Promise<SceneView> {
    return new SceneView(await Stage.create(host, forceWebGL), host, events);
  }

  private constructor(
    private readonly stage: Stage,
    private readonly host: HTMLElement,
    private readonly events: ViewEvents,
  ) {
    this.viewpoint = new Viewpoint(stage.canvas, () => this.update());
    const { camera, controls } = this.viewpoint;
    this.gizmo = new Gizmo(stage.scene, camera, stage.canvas, {
      onChange: () => stage.invalidate(),
      onHold: (isHeld) => {
        controls.enabled = !isHeld;
      },
      onPose: (model, phase) => this.moved(model, phase),
    });
    this.root.rotation.x = Math.PI;
    this.root.add(this.mark);
    stage.scene.add(this.root, camera, new HemisphereLight(0xffffff, 0xcfcac4, 2.3));
    this.pointer = this.listen();
    stage.run(camera, {
      onResize: (width, height) => this.viewpoint.resize(width, height),
      onFrame: (heightPx, height) => {
        const isMoving = this.animations.step();
        const isGliding = this.glideOn();
        const isDamping = controls.update();
        this.sizes.spread(camera, height);
        this.planes?.draw(JSON.stringify([this.display, this.selected, this.plane, this.objects.length]));
        this.cloud?.prepare(camera, heightPx);
        return isMoving || isDamping || isGliding;
      },
      onCanvas: (canvas) => {
        this.viewpoint.connect(canvas);
        this.gizmo.connect(canvas);
        this.pointer.dispose();
        this.pointer = this.listen();
      },
    });
    this.update();
  }

  get backend() {
    return this.stage.backend;
  }

  private listen(): Pointer {
    const picked = (place: { x: number; y: number }) => {
      const { clientWidth: width, clientHeight: height } = this.stage.canvas;
      const { display, root, scene, viewpoint } = this;
      const models = display.mesh ? [...this.models.values()] : [];
      const cloud = display.cloud ? this.cloud : null;
      return pick({ place, size: { width, height } }, { camera: viewpoint.camera, root, models, cloud, scene });
    };
    return new Pointer(this.stage.canvas, {
      onClick: (place) => {
        if (this.gizmo.isBusy) return;
        const hit = picked(place);
        const { pixel } = hit ?? {};
        const index = pixel ? pixel.y * (this.scene?.width ?? 0) + pixel.x : -1;
        const id = hit?.id ?? this.objects.find(({ mask }) => mask[index])?.id ?? null;
        this.select(id);
        this.events.onSelect(id);
      },
      onDoubleClick: (place) => {
        const hit = this.gizmo.isBusy ? null : picked(place);
        if (hit) this.focus(hit.point);
      },
      onHover: (place) => this.events.onHover?.(place ? (picked(place)?.pixel ?? null) : null),
    });
  }

  /** Replaces the point cloud, forgets all poses, and resets the viewpoint. */
  setScene(scene: SceneInput): void {
    this.poses.clear();
    this.cloud?.dispose();
    this.scene = scene;
    const { near, far, frustum } = colours(this.display.theme, this.host);
    this.cloud = new Cloud(scene, near, far, this.stage.isSoftware ? maxPoints.software : maxPoints.hardware);
    const depths = sortedDepths(this.cloud.points);
    const [first, last] = [quantile(depths, 0.01) || 1, quantile(depths, 0.99) || 1];
    this.root.add(this.cloud.object, this.cloud.veil);
    this.surroundings.setScene(scene, first, last, frustum);
    this.viewpoint.setScene(scene, first, last);
    this.lookFrom(this.look, this.fits);
    this.highlight();
  }

  /**
   * Replaces all objects. Objects with a known id keep their pose. Rejects if a GLB is not readable; the objects are
   * then unchanged.
   */
  async setObjects(objects: ObjectInput[]): Promise<void> {
    const attempt = ++this.loading;
    const before = new Map(this.objects.map((object) => [object.id, object]));
    const kept = ({ id, mesh, colour }: ObjectInput) => {
      const old = before.get(id);
      return old?.mesh === mesh && old.colour === colour ? this.models.get(id) : undefined;
    };
    const loaded = await Promise.allSettled(objects.map((object) => kept(object) ?? Model.load(object)));
    const models = loaded.flatMap((result) => (result.status === "fulfilled" ? [result.value] : []));
    const fresh = models.filter((model) => this.models.get(model.id) !== model);
    const failed = loaded.find((result) => result.status === "rejected");
    if (failed !== undefined || attempt !== this.loading) {
      for (const model of fresh) model.dispose();
      if (failed !== undefined) throw failed.reason;
      return;
    }
    this.gizmo.set(null, null, this.gizmoSettings);
    for (const model of this.models.values()) if (!models.includes(model)) model.dispose();
    this.models.clear();
    for (const model of models) {
      this.models.set(model.id, model);
      const pose = this.poses.get(model.id);
      if (pose !== undefined) model.pose = pose;
      this.root.add(model.pivot);
    }
    for (const id of [...this.poses.keys()]) if (!this.models.has(id)) this.poses.delete(id);
    this.objects = objects;
    if (this.selected !== null && !this.models.has(this.selected)) this.selected = null;
    if (!this.viewpoint.isTouched) this.lookFrom(this.look, this.fits);
    this.highlight();
  }

  /** Sets the pose of a mesh. Resolves at the end of the animation; there is none if the user prefers reduced motion. */
  async setPose(id: string, pose: Matrix, animate?: Animation): Promise<void> {
    this.animations.stop(id);
    this.poses.set(id, pose);
    const model = this.models.get(id);
    if (!model) return;
    if (animate && animate.durationMs > 0 && !isMotionReduced()) {
      const end = this.animations.start(id, animate, pose, model.centre, (at) => {
        model.pose = at;
      });
      this.update();
      await end;
    } else model.pose = pose;
    this.update();
  }

  /** What a mesh is drawn in. */
  colouringOf(id: string): Colouring {
    return this.models.get(id)?.colouring ?? "textures";
  }

  /** Shows a mesh in the light that the photo has, by channels. */
  setLight(id: string, light: readonly number[]): void {
    this.models.get(id)?.setLight(light);
    this.stage.invalidate();
  }

  private moved(model: Model, phase: "drag" | "end"): void {
    const { pose } = model;
    if (!pose) return;
    this.animations.stop(model.id);
    this.poses.set(model.id, pose);
    this.showSizes();
    this.stage.invalidate();
    this.events.onPose(model.id, pose, phase);
  }

  select(id: string | null): void {
    if (id === this.selected) return;
    this.selected = id;
    this.highlight();
  }

  /** Shows the gizmo at the selected mesh; `null` hides it. */
  setGizmo(mode: GizmoMode | null, settings = this.gizmoSettings): void {
    this.gizmoMode = mode;
    this.gizmoSettings = settings;
    this.update();
  }

  /** Shows the ground as a grid; `null` hides it. */
  setGround(plane: PlaneInput | null): void {
    this.plane = plane;
    this.viewpoint.setUp(plane && toThree(plane.normal));
    this.surroundings.setGround(plane, this.extent(), colours(this.display.theme, this.host).frustum);
    this.update();
  }

  setDisplay(display: Display): void {
    const isOther = display.theme !== this.display.theme;
    this.display = { ...display };
    if (isOther) {
      const { near, far, frustum } = colours(display.theme, this.host);
      this.cloud?.setTheme(near, far);
      this.surroundings.recolour(frustum);
      this.highlight();
    }
    this.update();
  }

  /** With `fits`, the view from the depth camera is zoomed to the objects. */
  lookFrom(which: Look, fits = false): void {
    this.look = which;
    this.fits = fits;
    this.glide = null;
    this.aim(this.extent());
    this.update();
  }

  private aim(at: Extent): void {
    const { look, fits, scene, objects, models } = this;
    this.aimed = at;
    this.viewpoint.lookFrom(look, toThree(at.centre), at.radius, fits && scene ? cropOf(scene, objects, models) : null);
  }

  /** Moves the viewpoint on its way to another extent. Returns whether it is still on the way. */
  private glideOn(): boolean {
    const { glide } = this;
    if (glide === null || this.viewpoint.isTouched) return false;
    const share = Math.min((performance.now() - glide.started) / GLIDE_MS, 1);
    const mixed = (a: number, b: number) => a + (b - a) * eased(share);
    const { from, to } = glide;
    const centre = from.centre.map((x, k) => mixed(x, to.centre[k] as number)) as [number, number, number];
    this.aim({ centre, radius: mixed(from.radius, to.radius) });
    if (share === 1) this.glide = null;
    return share < 1;
  }

  /** Shows where other cameras are: their poses in the frame of the depth camera, 16 numbers each, column-major. */
  setCameras(poses: readonly Matrix[]): void {
    this.surroundings.setCameras(poses, this.scene, colours(this.display.theme, this.host).frustum);
    this.update();
  }

  /** Frames all objects at their present poses, unless the user has moved the viewpoint; it goes there, or is there at once. */
  frame(isAtOnce = false): void {
    // The grid surrounds the objects where they are now.
    if (this.plane !== null) this.setGround(this.plane);
    if (this.viewpoint.isTouched) return;
    if (isAtOnce || this.look === "camera" || isMotionReduced()) {
      this.lookFrom(this.look, this.fits);
      return;
    }
    this.glide = { from: this.aimed, to: this.extent(), started: performance.now() };
    this.stage.invalidate();
  }

  /** Orbits around a point of the OpenCV camera frame, metres. */
  focus(point: [number, number, number]): void {
    this.viewpoint.focus(toThree(point));
    this.update();
  }

  /** The extent of all objects: of their meshes, or of their points if there are no meshes. */
  private extent(): Extent {
    const corners = [...this.models.values()].flatMap((model) => model.corners() ?? []);
    const isOnTheWay = this.objects.some(({ id }) => this.animations.isRunning(id));
    const seen =
      this.cloud && (corners.length === 0 || isOnTheWay)
        ? extentOf(this.cloud.points, (pixel) => this.objects.some(({ mask }) => mask[pixel]))
        : null;
    if (corners.length === 0) return seen ?? { centre: [0, 0, 1], radius: 0.5 };
    // Where they are going is in sight, too.
    if (seen !== null) corners.push(new Vector3(...seen.centre));
    const { center, radius } = new Sphere().setFromPoints(corners);
    return { centre: center.toArray(), radius };
  }

  private highlight(): void {
    this.cloud?.highlight(this.objects, this.selected);
    this.update();
  }

  /** Applies the state to all parts of the view. */
  private update(): void {
    const { display, selected, stage, viewpoint } = this;
    stage.background = colours(display.theme, this.host).background;
    const showsGround = this.surroundings.hasImage && viewpoint.isCamera && display.cloud;
    this.surroundings.show(showsGround, !viewpoint.isCamera);
    if (this.cloud) {
      this.cloud.object.visible = display.cloud && !showsGround;
      this.cloud.veil.visible = showsGround;
      this.cloud.setPointSize(display.pointSize);
    }
    for (const model of this.models.values()) {
      model.show(display, model.id === selected, display.hidden?.includes(model.id));
    }
    this.showSizes();
    if ((display.planes === true) !== (this.planes !== null)) this.togglePlanes();
    this.gizmo?.set(this.models.get(selected ?? "") ?? null, this.gizmoMode, this.gizmoSettings);
    stage.canvas.setAttribute("aria-label", this.label());
    stage.invalidate();
  }

  private togglePlanes(): void {
    const surface = {
      stage: this.stage,
      model: () => this.models.get(this.selected ?? "") ?? null,
      plane: () => this.plane,
      undecorated: (draw: () => void) => this.undecorated(draw),
      onPose: (model: Model, phase: "drag" | "end") => this.moved(model, phase),
    };
    this.planes?.dispose();
    this.planes = this.planes ? null : new PlaneViews(this.host, surface);
    // Draws at once.
    this.stage.setShare(this.planes ? 1 - SHARE : 1);
  }

  /** Runs while points and meshes alone are visible. */
  private undecorated(draw: () => void): void {
    const { cloud, gizmo, mark, sizes } = this;
    this.surroundings.show(false, false);
    if (cloud) cloud.object.visible = this.display.cloud;
    whileHidden([gizmo.object, mark, ...sizes.objects, ...(cloud ? [cloud.veil] : [])], draw);
    this.update();
  }

  private showSizes(): void {
    const { dimensions, unit = null, unplaced = [] } = this.display;
    // Labels would cover the handles.
    const isShown = dimensions === true && this.gizmoMode === null;
    const isMeasured = (id: string) => isShown && !unplaced.includes(id) && !this.animations.isRunning(id);
    this.sizes.update(this.models, this.selected, unit, isMeasured);
  }

  /** A description for screen readers. */
  private label(): string {
    if (!this.cloud) return "3D view, empty";
    const { hidden = [], unplaced = [] } = this.display;
    const isPlaced = (id: string) => this.models.get(id)?.pose && ![...hidden, ...unplaced].includes(id);
    const placed = this.objects.filter(({ id }) => isPlaced(id)).map(({ id, name }) => name ?? id);
    const from = this.viewpoint.isCamera ? "camera" : this.look === "camera" ? "orbit" : this.look;
    return description(from, this.cloud.points.pixels.length, placed);
  }

  /** Marks a point (OpenCV camera frame, metres) with a ring; `null` removes it. */
  markPoint(point: [number, number, number] | null): void {
    this.mark.visible = point !== null;
    if (point !== null) this.mark.position.set(...point);
    this.stage.invalidate();
  }

  /** The view as a PNG of this size, without what is there to work with; `fillsView` leaves no bars beside the image. */
  picture(width: number, height: number, fillsView = true): Promise<Blob> {
    const { stage, viewpoint } = this;
    let taken: Promise<Blob> | null = null;
    viewpoint.fillsView = fillsView;
    whileHidden([this.gizmo.object, this.mark], () => {
      taken = stage.picture(width, height);
    });
    viewpoint.fillsView = false;
    stage.fit();
    return taken as unknown as Promise<Blob>;
  }

  dispose(): void {
    this.loading++;
    this.animations.stopAll();
    this.pointer.dispose();
    this.gizmo.dispose();
    this.sizes.dispose();
    this.viewpoint.dispose();
    for (const model of this.models.values()) model.dispose();
    this.models.clear();
    this.cloud?.dispose();
    release(this.mark);
    this.planes?.dispose();
    this.surroundings.dispose();
    this.stage.dispose();
  }
}

/** A point of the OpenCV camera frame in the frame of three.js. */
const toThree = ([x, y, z]: readonly [number, number, number]) => new Vector3(x, -y, -z);
