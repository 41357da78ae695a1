/** Makes and changes the draft. A draft without any problem becomes the scene by itself. */

import { alignAll } from "../alignment/align.js";
import { openVideo, trackAll } from "../alignment/video.js";
import { extractArchives } from "../input/archives.js";
import { type Draft, draft, draftInputs, isReady, marked, seenDoubts } from "../input/draft.js";
import { baseName } from "../input/files.js";
import { error, errorOf, type Problem } from "../input/problems.js";
import { readInputs, sceneOf } from "../input/reading.js";
import { asListed, isVideo } from "../input/video-frames.js";
import { isSession } from "../session/pack.js";
import { openProject } from "../session/project.js";
import {
  type Inputs,
  type MeshSource,
  type NamedFile,
  noInputs,
  type ObjectFiles,
  type Role,
  type Typed,
  withId,
} from "../state/inputs.js";
import { page } from "../state/page.js";
import { problemsOf } from "./checks.js";
import { fromSam3d, isUnassigned, rolesOf } from "./file-roles.js";
import { scenesOf } from "./grouping.js";

const { announce, enlist, inputs, scene, show, video } = page;

/** The number of the last change. The results of earlier ones are discarded. */
let lastChange = 0;

/** Whether a draft waits for its depth map. */
const lacksDepth = ({ depth, files }: Inputs) => depth === null && files.some(({ role }) => role !== "unused");

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
    refuse(errorOf("files", cause));
  }
}

/** Reads which files there are; null for a project, which is opened. */
async function readDrop(files: readonly NamedFile[]): Promise<Drop | null> {
  const extracted = await extractArchives(files);
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
  if (typed.every((one) => (one.role === "unused" && !isUnassigned(one)) || one.role === "resource")) {
    const names = typed.slice(0, 3).map(({ file }) => file.path);
    return refuse(error("files", `None of the files is an input (${names.join(", ") || "no files"}).`));
  }
  const scenes = scenesOf(typed).map((one) => ({ ...one, ...more }));
  const open = draft.peek();
  if (open !== null) {
    const depths = typed.filter(({ role }) => role === "depth").length;
    if (depths === 0 || (depths === 1 && lacksDepth(draftInputs(open)))) {
      return rebuild(replaced(draftInputs(open).files, typed));
    }
    const others = open.isEdit ? [] : open.scenes.filter(({ files }) => files.length > 0);
    return proposeScenes([...others, ...scenes], others.length);
  }
  const shown = inputs.peek();
  if (shown.sample === null && shown.depth !== null && canReplace(typed)) {
    return set({ scenes, index: 0, isVideo: false, isEdit: false, forShown: typed });
  }
  await proposeScenes(scenes);
}

/** Proposes scenes, one of which is looked at. */
export function proposeScenes(scenes: readonly Inputs[], index = 0): Promise<void> {
  return set({ scenes, index, isVideo: isVideo(scenes), isEdit: false });
}

/** Puts the files of the draft into the scene that is shown, in place of those that they name. */
export async function putIntoShown(): Promise<void> {
  const typed = draft.peek()?.forShown;
  if (typed === undefined) return;
  // A frame of a video with other files is a scene of its own.
  const shown = { ...inputs.peek(), ...(video.peek() !== null && { id: "" }) };
  const before = { ...shown, files: filesOf(shown) };
  await edit(rebuilt(before, replaced(before.files, typed)));
}

/** Takes the scenes as the frames of one video, or as scenes of their own. */
export async function asVideo(isOne: boolean): Promise<void> {
  const open = draft.peek();
  if (open !== null) await set({ ...open, isVideo: isOne }, false);
}

/** Makes the inputs of the scene that is shown a draft. */
export function edit(inputs: Inputs): Promise<void> {
  return set({ scenes: [{ ...inputs, files: filesOf(inputs) }], index: 0, isVideo: false, isEdit: true });
}

/** Makes inputs the scene that is shown, unless they raise a question that nobody has seen. */
export async function remake(inputs: Inputs): Promise<void> {
  await edit({ ...inputs, ...ownName(inputs), files: filesOf(inputs) });
  await acceptIfClear();
}

/** Makes inputs a draft in which the mask of an object is marked. */
export async function correct(inputs: Inputs, object: number): Promise<void> {
  const named = { ...inputs, ...ownName(inputs), files: filesOf(inputs) };
  await set({ scenes: [named], index: 0, isVideo: false, isEdit: true, isCorrection: true });
  if (draft.peek()?.isCorrection) marked.value = object;
}

/** Opens the draft, unless it raises a question that nobody has seen. */
export async function acceptIfClear(): Promise<void> {
  if (draft.peek()?.problems.every(isSeen)) await accept();
}

const isSeen = ({ kind, message }: Problem) => kind === "doubt" && seenDoubts.has(message);

/** Looks at another scene of the draft. */
export async function look(index: number): Promise<void> {
  const open = draft.peek();
  if (open !== null) await set({ ...open, index });
}

/** Changes the inputs of the draft. If that completes it, it opens by itself only where `opens` says so. */
export async function change(apply: (inputs: Inputs) => Inputs, opens = false): Promise<void> {
  const open = draft.peek();
  if (open === null) return;
  const changed = apply(draftInputs(open));
  // What was changed by hand is a scene of its own.
  const { forShown: _, ...rest } = open;
  await set({ ...rest, scenes: open.scenes.map((one, i) => (i === open.index ? changed : one)) }, opens);
}

/** Files for a field of the draft, whatever their names. */
export async function choose(role: Exclude<Role, "unused">, files: readonly NamedFile[]): Promise<void> {
  const [file] = files;
  const open = draft.peek();
  if (file === undefined || open === null) return;
  const inputs = draftInputs(open);
  if (role === "depth" || role === "photo" || role === "camera") {
    const kept = inputs.files.filter((one) => one.role !== role);
    const camera = { kind: "file", file } as const;
    const named = { ...inputs, ...ownName(inputs), files: [...kept, { file, role }] };
    const own = role === "depth" ? { ...named, depthKind: null } : named;
    return change(() => ({ ...own, [role]: role === "camera" ? camera : file }), true);
  }
  const typed = rolesOf(files).map((one) => (one.role === "resource" ? one : { file: one.file, role }));
  const others: readonly Role[] = role === "mask" ? ["mask", "truth"] : ["mesh", "resource", "truth"];
  await rebuild([...inputs.files.filter((one) => !others.includes(one.role)), ...typed]);
}

/** Gives a file another role. */
export async function assign(file: NamedFile, role: Role): Promise<void> {
  const open = draft.peek();
  if (open === null) return;
  await rebuild(draftInputs(open).files.map((one) => (one.file === file ? { file, role } : one)));
}

/** Makes the draft the scene that is shown, and aligns it. */
export async function accept(): Promise<void> {
  const open = draft.peek();
  if (open === null || !isReady(open) || open.reading === null) return;
  const inputs = draftInputs(open);
  const opened = sceneOf(inputs, open.reading);
  if (opened === null) return;
  lastChange++;
  draft.value = null;
  for (const { message } of open.problems) seenDoubts.add(message);
  if (open.isVideo) {
    const listed = asListed(open.scenes);
    // Tracking starts with the first frame, whichever is looked at.
    if (!(await openVideo(listed))) {
      draft.value = draft.peek() ?? open;
      return announce("The first frame could not be read.", "failed");
    }
    enlist([listed]);
    await trackAll();
    return;
  }
  const scenes = open.scenes.map((one) => (one.sample === null ? withId(one) : one));
  if (scenes.length > 1) enlist(scenes);
  show(opened, scenes[open.index] as Inputs);
  await alignAll(page);
}

/** Discards the draft. */
export function dismiss(): void {
  lastChange++;
  draft.value = null;
  announce("Nothing was changed.");
}

/** What can be put into a scene that is there: all but its depth map, with which a new scene begins. */
const replaceable: readonly Role[] = ["photo", "camera", "mask", "mesh", "resource", "truth"];

/** Whether files can be put into a scene that is there. */
const canReplace = (typed: readonly Typed[]): boolean =>
  typed.some(({ role }) => role !== "resource" && replaceable.includes(role)) &&
  typed.every(({ role }) => role === "unused" || replaceable.includes(role));

/** The files with others in place of those of the same role and name; there is one photo, and one camera. */
function replaced(before: readonly Typed[], typed: readonly Typed[]): Typed[] {
  const gone = typed.flatMap(({ file: { path }, role }) => {
    const alike = before.filter((one) => one.role === role);
    if (role === "photo" || role === "camera") return alike;
    const namesakes = alike.filter(({ file }) => baseName(file.path) === baseName(path));
    const same = namesakes.find(({ file }) => file.path === path);
    return same === undefined && namesakes.length > 1 ? [] : [same ?? namesakes[0]];
  });
  return [...before.filter((one) => !gone.includes(one)), ...typed];
}

/** Makes the scene of the draft anew from its files. */
async function rebuild(files: readonly Typed[]): Promise<void> {
  const open = draft.peek();
  if (open !== null) await change(() => rebuilt(draftInputs(open), files), true);
}

/** The scene of other files. What was entered stays, and so do pairs of files that are still there. */
function rebuilt(before: Inputs, files: readonly Typed[]): Inputs {
  const [after] = scenesOf(files);
  if (after === undefined) return before;
  const { depthScale, depthKind, resizeMasks } = before;
  const camera = before.camera?.kind === "file" ? after.camera : (after.camera ?? before.camera);
  const paired = new Set<MeshSource>();
  const objects = after.objects.map((object) => {
    const known = before.objects.find(({ mask }) => mask !== null && mask.file === object.mask?.file);
    if (known === undefined) return object;
    const mesh = after.meshes.find(({ file }) => file === known.mesh?.file) ?? object.mesh;
    if (mesh !== null) paired.add(mesh);
    return { ...object, name: known.name, mask: known.mask, mesh };
  });
  // A mesh of which a pair is kept is that of no other object.
  const isTaken = ({ mask, mesh }: ObjectFiles) => mesh !== null && paired.has(mesh) && mask === null;
  return {
    ...after,
    ...{ id: before.id, imageId: before.imageId ?? after.imageId, objects: objects.filter((one) => !isTaken(one)) },
    ...{ depthScale, depthKind, resizeMasks, camera, ...ownName(before) },
  };
}

/** A sample with other files is no sample. */
const ownName = ({ sample, name }: Inputs) => ({ sample: null, name: sample === null ? name : "Own files" });

async function set(next: Omit<Draft, "reading" | "problems" | "progress">, opens = true): Promise<void> {
  const change = ++lastChange;
  let progress = { done: 0, total: 0 };
  draft.value = { ...next, reading: null, problems: [], progress };
  const inputs = next.scenes[next.index] as Inputs;
  const reading = await readInputs(inputs, (now) => {
    progress = now;
    if (change === lastChange) draft.value = { ...next, reading: null, problems: [], progress };
  });
  if (change !== lastChange) return;
  const problems = problemsOf(inputs, reading);
  draft.value = { ...next, reading, problems, progress };
  announce(problems[0]?.message ?? `${inputs.name} can be opened.`, problems.length > 0 ? "failed" : "done");
  const isWhole = problems.length === 0 && (next.scenes.length === 1 || next.isVideo);
  if (opens && isWhole && !next.isEdit && !hasWork()) await accept();
}

/** Whether the sample that is shown has poses that were set by hand: unlike the user's own scenes, it is not kept. */
const hasWork = () =>
  scene.peek()?.sample !== null && scene.peek()?.objects.some(({ pose }) => pose.peek().source === "hand") === true;

/** Shows what is wrong with the files as a whole. */
function refuse(problem: Problem): void {
  const open = draft.peek();
  const empty = {
    scenes: [{ ...noInputs, name: "New scene" }],
    index: 0,
    reading: null,
    isVideo: false,
    isEdit: false,
    progress: { done: 0, total: 0 },
  };
  draft.value = { ...(open ?? empty), problems: [problem] };
  announce(problem.message, "failed");
}

/** The files of inputs with their roles, also of a sample. */
function filesOf(inputs: Inputs): Typed[] {
  if (inputs.files.length > 0) return [...inputs.files];
  const typed: (Typed | null)[] = [
    inputs.depth && { file: inputs.depth, role: "depth" },
    inputs.photo && { file: inputs.photo, role: "photo" },
    inputs.camera?.kind === "file" ? { file: inputs.camera.file, role: "camera" } : null,
    ...inputs.objects.flatMap(({ mask, mesh, truth }): (Typed | null)[] => [
      mask && { file: mask.file, role: "mask" },
      mesh && { file: mesh.file, role: "mesh" },
      truth && { file: truth, role: "truth" },
    ]),
  ];
  return typed.filter((one) => one !== null);
}
