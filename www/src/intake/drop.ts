/** Takes in the files of a drop: as a project, as new scenes, or as parts of the draft that is open. */
import { extractArchives } from "../input/archives.js";
import { draft, draftInputs } from "../input/draft.js";
import { error, errorOf } from "../input/problems.js";
import { asListed } from "../input/video-frames.js";
import { isSession } from "../session/pack.js";
import { openProject } from "../session/project.js";
import type { Inputs, NamedFile, Typed } from "../state/inputs.js";
import { page } from "../state/page.js";
import { canReplace, replaced } from "./changed-files.js";
import { proposeScenes, rebuild, refuse, set } from "./draft.js";
import { fromSam3d, isUnassigned, rolesOf } from "./file-roles.js";
import { scenesOf } from "./grouping.js";

const { announce, enlist, inputs, unpacking } = page;

/** Whether a draft waits for its depth map. */
const lacksDepth = ({ depth, files }: Inputs) => depth === null && files.some(({ role }) => role !== "unused");

const FILM = /\.(mp4|mov|mkv|avi|webm|m4v)$/i;

/** The files of a drop with their roles, and how their depth is read where that is known. */
interface Drop {
  typed: readonly Typed[];
  more: Partial<Pick<Inputs, "depthKind" | "resizeMasks">>;
}

/** Drops are read one after the other, so that a second one joins the first. */
let lastDrop: Promise<unknown> = Promise.resolve();

/** Proposes files as one or several scenes. A draft that is open takes them. */
export async function propose(files: readonly NamedFile[]): Promise<void> {
  const reading = lastDrop.then(() => readDrop(files));
  lastDrop = reading.catch(() => {});
  try {
    const drop = await reading;
    if (drop !== null) await place(drop);
  } catch (cause) {
    if (cause instanceof Stopped) announce("Nothing was opened.");
    else refuse(errorOf("files", cause));
  }
}

/** Unpacks archives. A person can stop it. */
async function unpacked(files: readonly NamedFile[]): Promise<NamedFile[]> {
  let isStopped = false;
  const cancel = () => {
    isStopped = true;
  };
  try {
    return await extractArchives(files, (share) => {
      if (isStopped) throw new Stopped();
      unpacking.value = { share, cancel };
    });
  } finally {
    unpacking.value = null;
  }
}

class Stopped extends Error {}

/** Reads which files there are; null for a project, which is opened. */
async function readDrop(files: readonly NamedFile[]): Promise<Drop | null> {
  const extracted = await unpacked(files);
  if (extracted.some(isSession)) {
    if (!(await openProject(extracted))) throw new Error("The project was saved by another version of this page.");
    draft.value = null;
    return null;
  }
  const converted = await fromSam3d(extracted);
  if (converted === null) return { typed: rolesOf(extracted), more: {} };
  const { files: made, depthKind, left } = converted;
  const typed = [...rolesOf(made), ...left.map((file): Typed => ({ file, role: "unused" }))];
  // Point maps of large images are smaller than the images.
  return { typed, more: { depthKind, resizeMasks: true } };
}

/** Makes the files of a drop a draft, or a part of the draft that is open. */
async function place({ typed, more }: Drop): Promise<void> {
  const isFilm = typed.every(({ file: { path }, role }) => role === "unused" && FILM.test(path));
  if (isFilm || typed.every((one) => (one.role === "unused" && !isUnassigned(one)) || one.role === "resource")) {
    const names = typed.slice(0, 3).map(({ file }) => file.path);
    const film = isFilm
      ? " Save the frames of the video as pictures, with a depth map each, and drop their folder."
      : "";
    return refuse(error("files", `None of the files is an input (${names.join(", ") || "no files"}).${film}`));
  }
  const scenes = scenesOf(typed).map((one) => ({ ...one, ...more }));
  const open = draft.peek();
  if (open !== null) {
    const both = [...(open.forShown ?? []), ...typed];
    if (open.forShown !== undefined && canReplace(both)) {
      return set({ ...open, scenes: scenesOf(both).map((one) => ({ ...one, ...more })), index: 0, forShown: both });
    }
    const depths = typed.filter(({ role }) => role === "depth").length;
    if (depths === 0 || (depths === 1 && lacksDepth(draftInputs(open)))) {
      return rebuild(replaced(draftInputs(open).files, typed));
    }
    // A video is listed as one, to be opened later.
    if (open.isVideo) enlist([asListed(open.scenes)]);
    const others = open.isVideo ? [] : open.scenes.filter(({ files }) => files.length > 0);
    return proposeScenes([...others, ...scenes], others.length);
  }
  const shown = inputs.peek();
  if (shown.sample === null && shown.depth !== null && canReplace(typed)) {
    return set({ scenes, index: 0, isVideo: false, isEdit: false, forShown: typed });
  }
  await proposeScenes(scenes);
}
