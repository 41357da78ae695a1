/** A workspace: a scene, and all that is done with it. The page has one, and every `<sim3-align>` its own. */
import { type ReadonlySignal, signal } from "@preact/signals";
import type { SceneView } from "../view3d/scene-view.js";
import { displayState } from "./display.js";
import { historyState } from "./history.js";
import type { ObjectModel } from "./object-model.js";
import { openedState } from "./opened.js";
import { optionsState } from "./options.js";
import { runningState, statusState } from "./running.js";
import { sceneState } from "./scene.js";
import { videoState } from "./video.js";

/** The state of the 3D view. */
export type SpaceState = { kind: "loading" } | { kind: "ready"; view: SceneView } | { kind: "none"; reason: string };

/** What surrounds a workspace. */
interface Surroundings {
  theme: ReadonlySignal<"light" | "dark">;
}

export type Workspace = ReturnType<typeof createWorkspace>;

export function createWorkspace({ theme }: Surroundings) {
  const [scene, display, status, video] = [sceneState(), displayState(), statusState(), videoState()];
  const opened = openedState(scene, display, status, video);
  const isReadonly = signal(false);
  return {
    ...scene,
    ...display,
    ...status,
    ...opened,
    ...video,
    ...historyState(scene, status, opened),
    ...optionsState(),
    ...runningState(scene),
    theme,
    /** Whether the scene is read-only. */
    isReadonly,
    /** Whether the mesh of an object is drawn: of a read-only scene, a start pose would look like a result. */
    isMeshShown: ({ isPlaced, isShown }: ObjectModel) => isShown.value && (isPlaced || !isReadonly.value),
    space: signal<SpaceState>({ kind: "loading" }),
    /** Whether the first alignment has ended. The 3D view loads afterwards, so that it does not slow the alignment down. */
    isSettled: signal(false),
    /** The canvas of the image view. */
    imageCanvas: signal<HTMLCanvasElement | null>(null),
  };
}
