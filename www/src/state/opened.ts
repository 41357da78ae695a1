/** The inputs of the scene that is shown. */
import { batch, signal } from "@preact/signals";
import type { DisplayState } from "./display.js";
import { type Inputs, noInputs, withId } from "./inputs.js";
import type { ObjectModel } from "./object-model.js";
import type { Progress } from "./progress.js";
import type { StatusState } from "./running.js";
import type { Scene, SceneState } from "./scene.js";
import type { VideoState } from "./video.js";

/** What is looked for: what needs a person, what is not decided on, or anything. */
export type SceneKind = "doubtful" | "open" | "any";

/** The same, or a later frame that is not decided on. */
export type NextKind = SceneKind | "frame";

/** What the page does with files; an embedded scene has none of it. */
export interface FileActions {
  /** Changes the files of the scene. */
  edit(): void;
  /** Changes how they are read, and aligns anew, unless that raises a question. */
  change(apply: (inputs: Inputs) => Inputs): void;
  /** Corrects the mask of the object with this index. */
  correct(object: number): void;
  /** Shows the next scene of the list or, without any, a sample. */
  another(): Promise<void>;
  /** What a person can do about an error, in place of what a program can. */
  words(error: Error): string;
  /** Shows the next frame or scene of this kind. Returns whether there is one. */
  next(kind: NextKind): boolean;
}

/** One of the user's own scenes. */
export interface Listed {
  inputs: Inputs;
  /** How far the work was when it was last shown; null if it was not opened yet. */
  progress: Progress | null;
}

/** A scene that another tab of this browser shows and keeps. */
export interface Foreign {
  id: string;
  name: string;
}

/** The state of what is opened. */
export function openedState(
  { scene, support }: SceneState,
  { layers, setLayer }: DisplayState,
  { announce }: StatusState,
  { video }: VideoState,
) {
  /** The inputs of the scene that is shown, or of the sample that is being read. */
  const inputs = signal<Inputs>(noInputs);
  const isReading = signal(false);
  /** The files of a drop that are being unpacked: how much of them, and what stops it. */
  const unpacking = signal<{ share: number; cancel(): void } | null>(null);
  /** The user's own scenes in the order in which they came, with those that are still to be opened. */
  const list = signal<readonly Listed[]>([]);
  /** Which of them are listed, and whether the least sure ones come first. */
  const listed = signal<{ kind: SceneKind; isSorted: boolean }>({ kind: "any", isSorted: false });
  /** The scenes of other tabs. */
  const othersScenes = signal<readonly Foreign[]>([]);
  /** Why the browser does not keep a scene; null while it keeps all. */
  const notKept = signal<string | null>(null);
  const fileActions = signal<FileActions | null>(null);

  /** Adds scenes to the list, or replaces those with the same ids. */
  function enlist(scenes: readonly Inputs[]): void {
    const known = list.peek();
    const replaced = known.map((one) => {
      const other = scenes.find(({ id }) => id === one.inputs.id);
      return other === undefined ? one : { ...one, inputs: other };
    });
    const fresh = scenes.filter(({ id }) => !known.some((one) => one.inputs.id === id));
    list.value = [...replaced, ...fresh.map((inputs) => ({ inputs, progress: null }))];
  }

  /** Makes a scene the one that is shown. It is listed, unless it is a sample or a frame of a video. */
  function show(opened: Scene, from: Inputs, isListed = opened.sample === null): void {
    const own = isListed ? withId(from) : from;
    batch(() => {
      isReading.value = false;
      inputs.value = own;
      support.value = null;
      scene.value = opened;
      if (isListed) enlist([own]);
      const base = opened.rgba === null ? "depth" : "photo";
      if (layers.peek().base !== base) setLayer("base", base);
    });
  }

  /** Changes the inputs of the scene that is shown, which stays as it is; in a video, of this frame or of all. */
  function amend(change: (inputs: Inputs) => Inputs, isForAll = false): void {
    const [shown, whole, opened] = [inputs.peek(), scene.peek(), video.peek()];
    const changed = change(shown);
    batch(() => {
      inputs.value = changed;
      if (opened !== null) {
        const frames = opened.frames.map((one) => (one === shown ? changed : isForAll ? change(one) : one));
        video.value = { ...opened, frames };
        enlist(list.peek().flatMap((one) => (one.inputs.id === shown.id ? { ...one.inputs, frames } : [])));
      } else if (changed.id !== "") enlist([changed]);
      if (whole !== null && changed.sample !== whole.sample)
        scene.value = { ...whole, name: changed.name, sample: changed.sample };
    });
  }

  /** Names an object, in all frames of a video. */
  function rename(object: ObjectModel, name: string): void {
    const index = scene.peek()?.objects.indexOf(object);
    object.title.value = name;
    amend((one) => ({ ...one, objects: one.objects.map((own, i) => (i === index ? { ...own, name } : own)) }), true);
  }

  /** Takes an object out of the scene. The others keep their poses. */
  function removeObject(object: ObjectModel): void {
    const [whole, from] = [scene.peek(), inputs.peek()];
    const index = whole?.objects.indexOf(object) ?? -1;
    if (whole === null || index < 0) return;
    const without = <T>(list: readonly T[]) => list.filter((_, i) => i !== index);
    const plane = support.peek();
    show(
      { ...whole, sample: null, objects: without(whole.objects) },
      { ...from, sample: null, objects: without(from.objects) },
    );
    support.value = plane;
    announce(`Removed ${object.name}.`);
  }

  return {
    inputs,
    isReading,
    unpacking,
    list,
    listed,
    othersScenes,
    notKept,
    fileActions,
    enlist,
    show,
    amend,
    rename,
    removeObject,
  };
}

export type OpenedState = ReturnType<typeof openedState>;
