/** Keeps the 3D view in sync with the state of the page. */
import { effect } from "@preact/signals";
import { compose, invert, toSim3 } from "sim3align/conventions/similarity";
import { depthImage } from "../pictures/colours.js";
import type { ObjectModel } from "../state/object-model.js";
import { type Pose, tightBoundsOf } from "../state/pose.js";
import type { Scene } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import type { SceneView } from "../view3d/scene-view.js";
import { loadThree } from "../view3d/three-source.js";
import type { ObjectInput } from "../view3d/types.js";

/** Duration of the animation from one pose to the next. */
const ANIMATION_MS = 900;

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
    view.lookFrom("camera", true);
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
      stopPoses = whole.objects.map((object) => followPose(workspace, view, object, isDragging));
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

function followPose(
  { showsBefore }: Workspace,
  view: SceneView,
  object: ObjectModel,
  isDragging: () => boolean,
): () => void {
  // If the view loads after the alignment, it still animates from the start pose.
  let shown: Pose = object.start.peek();
  return effect(() => {
    const pose = showsBefore.value ? object.start.value : object.pose.value;
    if (isDragging()) {
      shown = pose;
      return;
    }
    const isMoved = pose !== shown && pose.source !== "hand" && pose.source !== "tracked";
    const animate = isMoved ? { from: shown.transform.matrix, durationMs: ANIMATION_MS } : undefined;
    shown = pose;
    const shownAt = view.setPose(object.id, pose.transform.matrix, animate);
    shownAt.then(() => isMoved && pose === object.pose.peek() && view.frame(), console.error);
  });
}
