/** Makes and changes the draft. A draft without any problem becomes the scene by itself. */

import { alignAll } from "../alignment/align.js";
import { openVideo, trackAll } from "../alignment/video.js";
import { extractArchives } from "../input/archives.js";
import { type Draft, draft, draftInputs, isReady, marked, seenDoubts } from "../input/draft.js";
import { error, errorOf, type Problem } from "../input/problems.js";
import { readInputs, sceneOf } from "../input/read-scene.js";
import { asListed, isVideo } from "../input/video-frames.js";
import { isSession } from "../session/pack.js";
import { openProject } from "../session/project.js";
import { type Inputs, type NamedFile, noInputs, type Role, type Typed, withId } from "../state/inputs.js";
import { page } from "../state/page.js";
import { problemsOf } from "./checks.js";
import { canReplace, replaced } from "./replace.js";
import { rolesOf } from "./roles.js";
import { fromSam3d } from "./sam3d.js";
import { scenesOfTyped } from "./scenes.js";

const { announce, enlist, inputs, scene, show, video } = page;

/** The number of the last change. The results of earlier ones are discarded. */
let lastChange = 0;

/** Whether a draft waits for its depth map. */
const lacksDepth = ({ depth, files }: Inputs) => depth === null && files.some(({ role }) => role !== "unused");

/** Proposes files as one or several scenes. A draft that is open takes files without a depth map, and the one that it lacks. */
export async function propose(files: readonly NamedFile[]): Promise<void> {
  const change = ++lastChange;
  let typed: Typed[];
  let made: Awaited<ReturnType<typeof fromSam3d>> = null;
  try {
    const extracted = await extractArchives(files);
    if (change !== lastChange) return;
    if (extracted.some(isSession)) {
      if (!(await openProject(extracted))) {
        return refuse(error("files", "The project was saved by another version of this page."));
      }
      draft.value = null;
      return;
    }
    made = await fromSam3d(extracted);
    const left = made?.left.map((file): Typed => ({ file, role: "unused" })) ?? [];
    typed = [...(await rolesOf(made?.files ?? extracted)), ...left];
  } catch (cause) {
    if (change === lastChange) refuse(errorOf("files", cause));
    return;
  }
  if (change !== lastChange) return;
  if (typed.every(({ role }) => role === "unused" || role === "resource")) {
    const names = typed.slice(0, 3).map(({ file }) => file.path);
    return refuse(error("files", `None of the files is an input (${names.join(", ") || "no files"}).`));
  }
  const open = draft.peek();
  const depths = typed.filter(({ role }) => role === "depth").length;
  if (open !== null && (depths === 0 || (depths === 1 && lacksDepth(draftInputs(open))))) return add(open, typed);
  const scenes = await scenesOfTyped(typed);
  const shown = inputs.peek();
  if (shown.sample === null && shown.depth !== null && canReplace(typed)) {
    return set({ scenes, index: 0, isVideo: false, isEdit: false, forShown: typed });
  }
  // Point maps of large images are smaller than the images.
  const more = made === null ? {} : { depthKind: made.depthKind, resizeMasks: true };
  await proposeScenes(scenes.map((one) => ({ ...one, ...more })));
}

/** Proposes scenes, the first of which is looked at. */
export function proposeScenes(scenes: readonly Inputs[]): Promise<void> {
  return set({ scenes, index: 0, isVideo: isVideo(scenes), isEdit: false });
}

/** Puts the files of the draft into the scene that is shown, in place of those that they name. */
export async function putIntoShown(): Promise<void> {
  const typed = draft.peek()?.forShown;
  // A frame of a video with other files is a scene of its own.
  const shown = { ...inputs.peek(), ...(video.peek() !== null && { id: "" }) };
  if (typed !== undefined) await edit(await replaced({ ...shown, files: filesOf(shown) }, typed));
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
  const known = await rolesOf(files);
  const typed = known.map((one) => ({ file: one.file, role: fits(one.role, role) ? one.role : role }));
  const replaced: readonly Role[] =
    role === "mask" ? ["mask", "labels", "annotations", "truth"] : ["mesh", "resource", "truth"];
  await rebuild([...inputs.files.filter((one) => !replaced.includes(one.role)), ...typed]);
}

/** Whether the role that a name suggests is one that the field takes. */
function fits(role: Role, field: Role): boolean {
  return role === field || (field === "mask" ? role === "labels" || role === "annotations" : role === "resource");
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
    if (!(await openVideo(listed))) return announce("The first frame could not be read.", "failed");
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

async function add(open: Draft, typed: readonly Typed[]): Promise<void> {
  const single: readonly Role[] = ["photo", "camera"];
  const isReplaced = (one: Typed) => single.includes(one.role) && typed.some(({ role }) => role === one.role);
  await rebuild([...draftInputs(open).files.filter((one) => !isReplaced(one)), ...typed]);
}

/** Makes the scene anew from its files. What was entered stays. */
async function rebuild(files: readonly Typed[]): Promise<void> {
  const open = draft.peek();
  if (open === null) return;
  const before = draftInputs(open);
  const [after] = await scenesOfTyped(files);
  if (after === undefined) return;
  const { depthScale, depthKind, resizeMasks } = before;
  const camera = before.camera?.kind === "file" ? after.camera : (after.camera ?? before.camera);
  await change(() => ({ ...after, depthScale, depthKind, resizeMasks, camera, ...ownName(before) }), true);
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
      truth && { file: truth.file, role: "truth" },
    ]),
  ];
  return typed.filter((one) => one !== null);
}
