/** Folders with frames of one object on disk (Node only). */
import { readdir } from "node:fs/promises";
import { join } from "node:path";
import type { FrameFiles, ReadCaseOptions } from "./case-files.js";
import { fileIn, filesBelow } from "./case-folder.js";
import { type Folder, type Frames, frameNamesIn, framesIn } from "./frames.js";
import { unreadable } from "./read-files.js";
import type { AlignInput, MeshFile } from "./types/inputs.js";

function folderAt(root: string): Folder {
  const list = () =>
    readdir(root, { withFileTypes: true }).catch((cause) => {
      throw unreadable("case", root, "a folder with depth, mask and mesh", cause);
    });
  return {
    placeOf: (folder = "") => (folder === "" ? root : join(root, folder)),
    entries: async () =>
      (await list()).map((entry) => ({ name: entry.name, isFolder: entry.isDirectory() || entry.isSymbolicLink() })),
    below: (folder, levels) => filesBelow(join(root, folder), "", levels),
    file: (folder, path) => fileIn("case", join(root, folder), path),
  };
}

/** The names of the frames of a case, in order; none for a case of one view. */
export const frameNames = (folder: string): Promise<readonly string[]> =>
  frameNamesIn(folderAt(folder)).catch(() => []);

/** Opens a folder of frames on disk: see {@link framesIn}. */
export async function openFrames(folder: string, settings: ReadCaseOptions = {}): Promise<Frames> {
  return framesIn(folderAt(folder), settings);
}

/** A frame as an input for `align` and `evaluate`; `undefined` without a mask. */
export function inputOfFrame({ input }: Pick<FrameFiles, "input">, mesh: MeshFile): AlignInput | undefined {
  const { cameraToWorld: _, ...view } = input;
  return view.mask === undefined ? undefined : ({ ...view, mesh } as AlignInput);
}
