/** Recognises the frames of a video among the scenes of a drop. */
import type { Sim3 } from "sim3align";
import { parseCameraPose } from "sim3align/conventions/camera-pose-file";
import { toSim3 } from "sim3align/conventions/similarity";
import { type Inputs, noInputs, withId } from "../state/inputs.js";
import type { Video } from "../state/video.js";
import { titleOf } from "./names.js";

/** Whether the scenes can be frames: they show one object each, and have one mesh file in common. */
export function canBeVideo(scenes: readonly Inputs[]): boolean {
  const [first] = scenes;
  const file = first?.objects[0]?.mesh?.file;
  if (scenes.length < 2 || file === undefined) return false;
  return scenes.every(({ objects }) => objects.length === 1 && objects[0]?.mesh?.file === file);
}

/** Whether the names also say that they are: folders or files of frames, or numbers. */
export function isVideo(scenes: readonly Inputs[]): boolean {
  return canBeVideo(scenes) && scenes.every(({ depth }) => /frame|\d{3,}/i.test(depth?.path ?? ""));
}

/** The frames of a video, whose object is named after its mesh. */
function asFrames(scenes: readonly Inputs[]): Inputs[] {
  return scenes.map((scene) => {
    const objects = scene.objects.map((object) => ({ ...object, name: nameOf(object.mesh?.file.path ?? "") }));
    return { ...scene, objects };
  });
}

const nameOf = (path: string) => titleOf(path) || "Object";

/** The scene that stands for a video in lists: with the inputs of its first frame, and the name of the frames' folder. */
export function asListed(scenes: readonly Inputs[]): Inputs {
  const { id } = withId(noInputs);
  const frames = asFrames(scenes.map((scene) => ({ ...scene, id })));
  const [first] = frames as [Inputs, ...Inputs[]];
  const folders = frames.map(({ depth }) => depth?.path.split("/") ?? []);
  const shared = folders[0]?.filter((part, i, path) => i < path.length - 1 && folders.every((one) => one[i] === part));
  return { ...first, name: shared?.at(-1) ?? first.objects[0]?.name ?? first.name, frames };
}

/** The video of frames. */
export async function videoOf(frames: readonly Inputs[]): Promise<Video> {
  const cameras = await Promise.all(frames.map(cameraOf));
  const known = cameras.filter((camera) => camera !== null);
  return { frames, cameras: known.length === frames.length ? known : null };
}

/** The pose of a frame's camera; `null` without one that can be read. */
async function cameraOf({ files }: Inputs): Promise<Sim3 | null> {
  const file = files.find(({ role }) => role === "pose")?.file;
  if (file === undefined) return null;
  try {
    return toSim3(parseCameraPose("pose", await file.bytes()));
  } catch {
    return null;
  }
}
