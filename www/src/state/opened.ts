/** The inputs of the scene that is shown. */
import { batch, signal } from "@preact/signals";
import { type Inputs, noInputs } from "../load/inputs.js";
import type { DisplayState } from "./display.js";
import type { ObjectModel } from "./object-model.js";
import type { Scene, SceneState } from "./scene.js";
import type { StatusState } from "./status.js";

/** What the page does with files; an embedded scene has none of it. */
export interface FileActions {
  /** Changes the files of the scene. */
  edit(): void;
  /** Opens the next scene of the drop. */
  next(): void;
}

/** The state of what is opened. */
export function openedState({ scene }: SceneState, { layers, setLayer }: DisplayState, { announce }: StatusState) {
  /** The inputs of the scene that is shown, or of the sample that is being read. */
  const inputs = signal<Inputs>(noInputs);
  const isReading = signal(false);
  /** Scenes of the last drop that are still to be looked at. */
  const queue = signal<readonly Inputs[]>([]);
  const fileActions = signal<FileActions | null>(null);

  /** Makes a scene the one that is shown. */
  function show(opened: Scene, from: Inputs): void {
    batch(() => {
      isReading.value = false;
      inputs.value = from;
      scene.value = opened;
      const base = opened.rgba === null ? "depth" : "photo";
      if (layers.peek().base !== base) setLayer("base", base);
    });
  }

  /** Takes an object out of the scene. The others keep their poses. */
  function removeObject(object: ObjectModel): void {
    const [whole, from] = [scene.peek(), inputs.peek()];
    const index = whole?.objects.indexOf(object) ?? -1;
    if (whole === null || index < 0) return;
    const without = <T>(list: readonly T[]) => list.filter((_, i) => i !== index);
    show(
      { ...whole, sample: null, objects: without(whole.objects) },
      { ...from, sample: null, objects: without(from.objects) },
    );
    announce(`Removed ${object.name}.`);
  }

  return { inputs, isReading, queue, fileActions, show, removeObject };
}
