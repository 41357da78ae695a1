/** The 3D view: point cloud, meshes, gizmo and viewpoint. */
import { DirectionalLight, Group, HemisphereLight, Sphere, Vector3 } from "three/webgpu";
import { Animations } from "./animations.js";
import { Cloud } from "./cloud.js";
import { cropOf } from "./crop.js";
import { description } from "./description.js";
import { Floor } from "./floor.js";
import { Frustum } from "./frustum.js";
import { Gizmo } from "./gizmo.js";
import { Ground } from "./ground.js";
import { listenToOrbitKeys } from "./keys.js";
import { Marker } from "./marker.js";
import { Model } from "./model.js";
import { Picker } from "./picker.js";
import { Pointer } from "./pointer.js";
import { type Extent, extentOf, quantile, sortedDepths } from "./points.js";
import { Ruler } from "./ruler.js";
import { Sizes } from "./sizes.js";
import type { Stage } from "./stage.js";
import { colours } from "./theme.js";
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
  View,
  ViewEvents,
} from "./types.js";
import { Viewpoint } from "./viewpoint.js";

/** Screens resolve no more points, and software renderers draw no more in acceptable time. */
const maxPoints = { hardware: 400_000, software: 80_000 };

/** The implementation of the view. */
export class SceneView implements View {
  /** Its children are in the OpenCV camera frame. In three.js, y is up and z points towards the camera. */
  private readonly root = new Group();
  private readonly viewpoint: Viewpoint;
  private readonly gizmo: Gizmo;
  private readonly marker = new Marker();
  private readonly ruler = new Ruler();
  private floor: Floor | null = null;
  private plane: PlaneInput | null = null;
  private gizmoSettings: GizmoSettings = { isLocal: false, snaps: false };
  private readonly animations = new Animations();
  private readonly models = new Map<string, Model>();
  private readonly poses = new Map<string, Matrix | null>();
  private pointer: Pointer;
  private scene: SceneInput | null = null;
  private cloud: Cloud | null = null;
  private frustum: Frustum | null = null;
  private ground: Ground | null = null;
  /** The other cameras. */
  private readonly others: Frustum[] = [];
  /** About the depth of the nearest surfaces, metres. */
  private firstDepth = 1;
  private readonly sizes = new Sizes(this.root);
  private objects: readonly ObjectInput[] = [];
  private selected: string | null = null;
  private gizmoMode: GizmoMode | null = null;
  private look: Look = "orbit";
  private fits = false;
  private loading = 0;
  private display: Display = { cloud: true, mesh: true, wireframe: false, pointSize: 1.2, theme: "light" };

  constructor(
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
    this.root.add(this.marker.object, this.ruler.object);
    this.orbitByKeys(stage.canvas);
    // The light moves with the camera.
    const lamp = new DirectionalLight(0xffffff, 2.1);
    lamp.position.set(-0.4, 1, 0.8);
    camera.add(lamp, lamp.target);
    stage.scene.add(this.root, camera, new HemisphereLight(0xffffff, 0x8d8a86, 1.5));
    this.pointer = this.listen();
    stage.run(camera, {
      onResize: (width, height) => this.viewpoint.resize(width, height),
      onFrame: (_, height) => {
        const isMoving = this.animations.step();
        const isDamping = controls.update();
        this.cloud?.prepare(camera, height);
        this.sizes.spread(camera, stage.canvas.clientHeight, this.ruler.shownLabels);
        return isMoving || isDamping;
      },
      onCanvas: (canvas) => {
        this.viewpoint.connect(canvas);
        this.gizmo.connect(canvas);
        this.pointer.dispose();
        this.pointer = this.listen();
        this.orbitByKeys(canvas);
      },
    });
    this.update();
  }

  get backend() {
    return this.stage.backend;
  }

  private orbitByKeys(canvas: HTMLCanvasElement): void {
    listenToOrbitKeys(canvas, (...turn) => {
      this.viewpoint.orbit(...turn);
      this.update();
    });
  }

  private listen(): Pointer {
    const picked = (place: { x: number; y: number }) => {
      const { clientWidth: width, clientHeight: height } = this.stage.canvas;
      const models = this.display.mesh ? [...this.models.values()] : [];
      const cloud = this.display.cloud ? this.cloud : null;
      return new Picker(this.viewpoint.camera, this.root).pick(place, { width, height }, models, cloud, this.scene);
    };
    return new Pointer(this.stage.canvas, {
      onClick: (place) => {
        if (this.gizmo.isBusy) return;
        const hit = picked(place);
        if (hit && this.events.onPick?.(hit.point)) return;
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
      onHover: (place) => {
        if (this.events.onHover) this.events.onHover(place ? (picked(place)?.pixel ?? null) : null);
      },
    });
  }

  setScene(scene: SceneInput): void {
    this.cloud?.dispose();
    this.frustum?.dispose();
    this.ground?.dispose();
    const { near, far, frustum } = colours(this.display.theme, this.host);
    this.scene = scene;
    this.cloud = new Cloud(scene, near, far, this.stage.isSoftware ? maxPoints.software : maxPoints.hardware);
    const depths = sortedDepths(this.cloud.points);
    const [first, last] = [quantile(depths, 0.01) || 1, quantile(depths, 0.99) || 1];
    this.firstDepth = first;
    this.frustum = new Frustum(scene, 0.22 * first, frustum);
    this.ground = scene.ground ? new Ground(scene, scene.ground, last) : null;
    this.root.add(this.cloud.object, this.frustum.object);
    if (this.ground) this.root.add(this.ground.object);
    this.viewpoint.setScene(scene, first, last);
    this.lookFrom(this.look, this.fits);
    this.highlight();
  }

  async setObjects(objects: ObjectInput[]): Promise<void> {
    const attempt = ++this.loading;
    const before = new Map(this.objects.map((object) => [object.id, object]));
    const isSame = (object: ObjectInput) => {
      const old = before.get(object.id);
      return old !== undefined && old.mesh === object.mesh && old.colour === object.colour;
    };
    const kept = (object: ObjectInput) => (isSame(object) ? this.models.get(object.id) : undefined);
    const loaded = await Promise.allSettled(objects.map((object) => kept(object) ?? Model.load(object)));
    const models = loaded.flatMap((result) => (result.status === "fulfilled" ? [result.value] : []));
    const fresh = models.filter((model) => this.models.get(model.id) !== model);
    const failed = loaded.find((result) => result.status === "rejected");
    if (failed !== undefined || attempt !== this.loading) {
      for (const model of fresh) model.dispose();
      if (failed !== undefined) throw failed.reason;
      return;
    }
    this.gizmo.set(null, null);
    for (const model of this.models.values()) if (!models.includes(model)) model.dispose();
    this.models.clear();
    for (const model of models) {
      this.models.set(model.id, model);
      model.pose = this.poses.get(model.id) ?? null;
      this.root.add(model.pivot);
    }
    for (const id of [...this.poses.keys()]) if (!this.models.has(id)) this.poses.delete(id);
    this.objects = objects;
    if (this.selected !== null && !this.models.has(this.selected)) this.selected = null;
    this.frame();
    this.highlight();
  }

  async setPose(id: string, pose: Matrix | null, animate?: Animation): Promise<void> {
    this.animations.stop(id);
    this.poses.set(id, pose);
    const model = this.models.get(id);
    if (!model) return;
    const isReduced = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (pose !== null && animate && animate.durationMs > 0 && !isReduced) {
      const end = this.animations.start(id, animate, pose, model.centre, (at) => {
        model.pose = at;
      });
      this.update();
      await end;
      this.update();
      return;
    }
    model.pose = pose;
    this.update();
  }

  /** Handles a drag of the gizmo. */
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

  setGizmo(mode: GizmoMode | null, settings = this.gizmoSettings): void {
    this.gizmoMode = mode;
    this.gizmoSettings = settings;
    this.update();
  }

  setGround(plane: PlaneInput | null): void {
    this.plane = plane;
    this.floor?.dispose();
    this.floor = null;
    if (plane !== null) {
      const { centre, radius } = this.extent();
      this.floor = new Floor(plane, centre, radius, colours(this.display.theme, this.host).frustum);
      this.root.add(this.floor.object);
    }
    this.update();
  }

  measure(points: readonly (readonly [number, number, number])[]): void {
    this.ruler.show(points);
    this.stage.invalidate();
  }

  setDisplay(display: Display): void {
    const isOther = display.theme !== this.display.theme;
    this.display = { ...display };
    if (isOther) {
      const { near, far, frustum } = colours(display.theme, this.host);
      this.cloud?.setTheme(near, far);
      this.frustum?.object.material.color.copy(frustum);
      this.highlight();
    }
    this.update();
  }

  lookFrom(which: Look, fits = false): void {
    this.look = which;
    this.fits = fits;
    const { centre, radius } = this.extent();
    this.viewpoint.lookFrom(
      which,
      toThree(centre),
      radius,
      fits && this.scene ? cropOf(this.scene, this.objects, this.models) : null,
    );
    this.update();
  }

  setCameras(poses: readonly Matrix[]): void {
    for (const frustum of this.others.splice(0)) frustum.dispose();
    if (!this.scene) return;
    const { frustum: colour } = colours(this.display.theme, this.host);
    for (const pose of poses) {
      const frustum = new Frustum(this.scene, 0.1 * this.firstDepth, colour);
      frustum.object.matrixAutoUpdate = false;
      frustum.object.matrix.fromArray(Array.from(pose));
      this.root.add(frustum.object);
      this.others.push(frustum);
    }
    this.update();
  }

  frame(): void {
    // The grid surrounds the objects where they are now.
    if (this.plane !== null) this.setGround(this.plane);
    if (!this.viewpoint.isTouched) this.lookFrom(this.look, this.fits);
  }

  focus(point: [number, number, number] = this.extent(this.selected).centre): void {
    this.viewpoint.focus(toThree(point));
    this.update();
  }

  /** The extent of an object, or of all objects: of their meshes, or of their points if there are no meshes. */
  private extent(id: string | null = null): Extent {
    const wanted = this.objects.filter((object) => id === null || object.id === id);
    const placed = wanted.flatMap((object) => this.models.get(object.id) ?? []).filter(({ pose }) => pose !== null);
    const corners = placed.flatMap((model) => model.corners() ?? []);
    if (corners.length > 0) {
      const { center, radius } = new Sphere().setFromPoints(corners);
      return { centre: center.toArray(), radius };
    }
    if (!this.cloud) return { centre: [0, 0, 1], radius: 0.5 };
    return extentOf(this.cloud.points, (pixel) => wanted.some(({ mask }) => mask[pixel]));
  }

  private highlight(): void {
    this.cloud?.highlight(this.objects, this.selected);
    this.update();
  }

  /** Applies the state to all parts of the view. */
  private update(): void {
    const { display, selected, stage, viewpoint } = this;
    stage.background = colours(display.theme, this.host).background;
    const showsGround = this.ground !== null && viewpoint.isCamera && display.cloud;
    if (this.ground) this.ground.object.visible = showsGround;
    if (this.cloud) {
      this.cloud.object.visible = display.cloud && !showsGround;
      this.cloud.setPointSize(display.pointSize);
    }
    if (this.frustum) this.frustum.object.visible = !viewpoint.isCamera;
    for (const { object } of this.others) object.visible = !viewpoint.isCamera;
    for (const model of this.models.values()) {
      model.show(display, model.id === selected, display.hidden?.includes(model.id));
    }
    this.showSizes();
    const model = selected === null ? undefined : this.models.get(selected);
    if (this.floor) this.floor.object.visible = !viewpoint.isCamera;
    this.gizmo?.set(model ?? null, this.gizmoMode);
    this.gizmo?.configure(this.gizmoSettings);
    stage.canvas.setAttribute("aria-label", this.label());
    stage.invalidate();
  }

  private showSizes(): void {
    const { display, animations } = this;
    const isShown = (id: string) => display.dimensions === true && !animations.isRunning(id);
    this.sizes.update(this.models, this.selected, isShown);
  }

  /** A description for screen readers. */
  private label(): string {
    if (!this.cloud) return "3D view, empty";
    const placed = this.objects.filter(({ id }) => this.models.get(id)?.pose).map(({ id, name }) => name ?? id);
    const from = this.viewpoint.isCamera ? "camera" : this.look === "camera" ? "orbit" : this.look;
    return description(from, this.cloud.points.pixels.length, placed);
  }

  mark(point: [number, number, number] | null): void {
    this.marker.point = point;
    this.stage.invalidate();
  }

  snapshot(): Promise<Blob> {
    return this.stage.snapshot();
  }

  dispose(): void {
    this.loading++;
    this.animations.stopAll();
    this.pointer.dispose();
    this.gizmo.dispose();
    this.marker.dispose();
    this.ruler.dispose();
    this.floor?.dispose();
    this.sizes.dispose();
    this.ground?.dispose();
    this.viewpoint.dispose();
    for (const model of this.models.values()) model.dispose();
    this.models.clear();
    this.cloud?.dispose();
    this.frustum?.dispose();
    for (const frustum of this.others) frustum.dispose();
    this.stage.dispose();
  }
}

/** A point of the OpenCV camera frame in the frame of three.js. */
const toThree = ([x, y, z]: readonly [number, number, number]) => new Vector3(x, -y, -z);
