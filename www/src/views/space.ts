/** Keeps the 3D view in sync with the state of the page. */
import { effect } from "@preact/signals";
import { compose, invert, toSim3 } from "sim3align/conventions/similarity";
import { depthImage } from "../pictures/colours.js";
import { lightOn } from "../pictures/light.js";
import type { ObjectModel } from "../state/object-model.js";
import { boundsOf, isResult, type Pose, startPose, tightBoundsOf } from "../state/pose.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import type { SceneView } from "../view3d/scene-view.js";
import { loadThree } from "../view3d/three-source.js";
import type { Matrix, ObjectInput } from "../view3d/types.js";
import { imageOf } from "./image.js";

/** Duration of the animation from one pose to the next. */
const ANIMATION_MS = 900;
/** How long meshes wait beside the scene that the page opens first, and each after the one before it. */
const [WAIT_MS, EACH_MS] = [1300, 250];

/** Creates the 3D view and subscribes it to the state, until the signal aborts. */
export async function mountSpace(workspace: Workspace, host: HTMLElement, signal: AbortSignal): Promise<void> {
  const { hoveredPixel, place, scene, select, space } = workspace;
  /** The object that is being dragged, with its pose before. */
  let dragged: { object: ObjectModel; from: Pose } | undefined;
  try {
    // three.js is larger than the rest of the page, so it loads last.
    await loadThree();
    const { SceneView } = await import("../view3d/scene-view.js");
    const view = await SceneView.create(
      host,
      {
        onPose(id, matrix, phase) {
          const object = scene.peek()?.objects.find((object) => object.id === id);
          if (object === undefined) return;
          dragged ??= { object, from: object.pose.peek() };
          const pose: Pose = { transform: toSim3(matrix), source: "hand", alignment: object.alignment.peek() };
          if (phase === "end") {
            place(object, pose, dragged.from);
            dragged = undefined;
          } else object.pose.value = pose;
        },
        onSelect: select,
        onHover: (pixel) => {
          hoveredPixel.value = pixel;
        },
      },
      new URLSearchParams(location.search).get("graphics") === "webgl",
    );
    if (signal.aborted) return view.dispose();
    space.value = { kind: "ready", view };
    view.lookFrom("orbit");
    const stop = subscribe(workspace, view, () => dragged !== undefined);
    signal.addEventListener("abort", () => {
      stop();
      space.value = { kind: "loading" };
      view.dispose();
    });
  } catch (error) {
    space.value = { kind: "none", reason: error instanceof Error ? error.message : String(error) };
  }
}

const objectInput = ({ id, name, colour, mask, mesh, glb }: ObjectModel): ObjectInput => ({
  ...{ id, name, colour, mask },
  mesh: viewMesh(mesh, glb),
  corners: tightBoundsOf(mesh).corners,
});

/** The meshes of the view. The frames of a video have one in common, which is loaded once. */
const viewMeshes = new WeakMap<object, ObjectInput["mesh"]>();

function viewMesh(mesh: ObjectModel["mesh"], glb: Uint8Array | null): ObjectInput["mesh"] {
  const known = viewMeshes.get(mesh);
  if (known !== undefined) return known;
  const made =
    glb !== null
      ? { glb }
      : {
          positions: mesh.positions,
          indices: Uint32Array.from(mesh.indices ?? { length: mesh.positions.length / 3 }, (x, i) => x ?? i),
        };
  viewMeshes.set(mesh, made);
  return made;
}

const sceneInput = ({ layers }: Workspace, { depthM, width, height, camera, rgba }: Scene) => ({
  ...{ depthM, width, height, camera },
  ground: rgba !== null && layers.peek().base === "photo" ? rgba : depthImage(depthM),
  ...(rgba === null ? {} : { rgba }),
});

function subscribe(workspace: Workspace, view: SceneView, isDragging: () => boolean): () => void {
  const {
    display3d,
    frameIndex,
    gizmo,
    gizmoSettings,
    isMeshShown,
    scene,
    selected,
    showsBefore,
    support,
    theme,
    unit,
    video,
  } = workspace;
  const stops: (() => void)[] = [];
  const follow = (apply: () => void) => stops.push(effect(apply));
  let stopPoses: (() => void)[] = [];
  let isStopped = false;
  // The view loads after the first alignment: what that has done is still shown.
  let isFirst = true;
  follow(() => {
    if (scene.value !== null) view.setScene(sceneInput(workspace, scene.value));
  });
  follow(() => {
    const whole = scene.value;
    for (const stop of stopPoses) stop();
    stopPoses = [];
    if (whole === null) return;
    view.setObjects(whole.objects.map(objectInput)).then(() => {
      if (isStopped || scene.peek() !== whole) return;
      const waiting = waitingPoses(whole);
      stopPoses = whole.objects.map((object, i) => {
        const waits = { matrix: waiting[i] as Matrix, delayMs: isFirst ? WAIT_MS + i * EACH_MS : null };
        return followPose(workspace, view, object, waits, isDragging);
      });
      isFirst = false;
      view.frame(true);
      view.select(selected.peek()?.id ?? null);
    }, console.error);
  });
  follow(() => {
    const idsOf = (isOf: (object: ObjectModel) => boolean) =>
      (scene.value?.objects ?? []).filter(isOf).map(({ id }) => id);
    const hidden = idsOf((object) => !isMeshShown(object));
    const unplaced = idsOf(({ isPlaced }) => showsBefore.value || !isPlaced);
    view.setDisplay({ ...display3d.value, hidden, unplaced, theme: theme.value, unit: unit.value });
  });
  follow(() => {
    const cameras = video.value?.cameras ?? null;
    const own = cameras?.[frameIndex.value];
    void scene.value;
    view.setCameras(
      cameras === null || own === undefined
        ? []
        : cameras.filter((one) => one !== own).map((one) => compose(invert(own), one).matrix),
    );
  });
  follow(() => view.select(selected.value?.id ?? null));
  follow(() => view.setGizmo(gizmo.value, gizmoSettings.value));
  follow(() => view.setGround(support.value));
  return () => {
    isStopped = true;
    for (const stop of [...stops, ...stopPoses]) stop();
  };
}

/** Of more objects, those that wait are not side by side. */
const FEW = 6;

/** Where meshes wait that have no pose yet: above the scene, side by side, all of one size, because theirs is not known. */
function waitingPoses({ objects }: Scene): Matrix[] {
  const seen = objects.map(({ visible }) => visible.peek());
  const size = seen.map(({ sizeM }) => sizeM).sort((a, b) => a - b)[Math.floor(seen.length / 2)] ?? 0.1;
  const mean = (k: number) => seen.reduce((sum, { centreM }) => sum + (centreM[k] as number), 0) / (seen.length || 1);
  return objects.map(({ mesh }, i) => {
    const [own = [0, 0, 0]] = [seen[i]?.centreM];
    const x = objects.length > FEW ? own[0] : mean(0) + 0.95 * size * (i - (objects.length - 1) / 2);
    const highest = Math.min(...seen.map(({ centreM }) => centreM[1]));
    return startPose(boundsOf(mesh), { centreM: [x, highest - 1.25 * size, mean(2)], sizeM: 0.8 * size }).matrix;
  });
}

interface Waiting {
  matrix: Matrix;
  /** How long it waits for its first pose; null for one that is there when the scene is opened. */
  delayMs: number | null;
}

function followPose(
  workspace: Workspace,
  view: SceneView,
  object: ObjectModel,
  { matrix: waiting, delayMs: firstDelayMs }: Waiting,
  isDragging: () => boolean,
): () => void {
  const { gizmo, showsBefore } = workspace;
  let delayMs = firstDelayMs ?? 0;
  let shown: Pose = firstDelayMs === null ? object.pose.peek() : object.start.peek();
  let isMoving = false;
  const light = ({ transform }: Pose) => {
    const drawn = imageOf(workspace).drawn.peek();
    const found = drawn && lightOn(drawn, object, transform.matrix, view.colouringOf(object.id));
    if (found !== null) view.setLight(object.id, found);
  };
  return effect(() => {
    const pose = showsBefore.value ? object.start.value : object.pose.value;
    if (isDragging()) {
      shown = pose;
      return;
    }
    const isMoved = pose !== shown && pose.source !== "hand" && pose.source !== "tracked";
    // Handles are at the start pose, which they change.
    const at = ({ source, transform }: Pose) =>
      source === "start" && gizmo.value === null ? waiting : transform.matrix;
    if (pose === shown && isMoving) return;
    const animate = isMoved ? { from: at(shown), durationMs: ANIMATION_MS, delayMs } : undefined;
    shown = pose;
    isMoving = isMoved;
    const shownAt = view.setPose(object.id, at(pose), animate);
    if (isResult(pose.source)) light(pose);
    // Where it waits is in sight from the beginning.
    if (pose.source === "start" || (isMoved && delayMs > 0)) view.frame(true);
    if (pose.source !== "start") delayMs = 0;
    shownAt.then(() => {
      if (!isMoved || pose !== object.pose.peek()) return;
      isMoving = false;
      view.frame();
    }, console.error);
  });
}
