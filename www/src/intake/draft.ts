/** Makes and changes the draft. A draft without any problem becomes the scene by itself. */

import { alignAll, alignSelected } from "../alignment/align.js";
import { openVideo, trackAll } from "../alignment/video.js";
import { type Draft, draft, draftInputs, isReady, marked, seenDoubts } from "../input/draft.js";
import { OWN_FILES } from "../input/names.js";
import type { Problem } from "../input/problems.js";
import { readInputs, sceneOf } from "../input/reading.js";
import { asListed, isVideo } from "../input/video-frames.js";
import { type Inputs, type NamedFile, noInputs, type Role, type Typed, withId } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { type Scene, visibleExtent } from "../state/scene.js";
import { filesOf, ownName, rebuilt, replaced } from "./changed-files.js";
import { problemsOf } from "./checks.js";
import { rolesOf } from "./file-roles.js";

const { amend, announce, enlist, inputs, join, list, objects, record, scene, select, show, video } = page;

/** The number of the last change. The results of earlier ones are discarded. */
let lastChange = 0;

/** Proposes scenes, one of which is looked at. */
export function proposeScenes(scenes: readonly Inputs[], index = 0): Promise<void> {
  return set({ scenes, index, isVideo: isVideo(scenes), isEdit: false });
}

/** Puts the files of the draft into the scene that is shown, in place of those that they name. */
export async function putIntoShown(): Promise<void> {
  const typed = draft.peek()?.forShown;
  if (typed === undefined) return;
  const before = { ...inputs.peek(), files: filesOf(inputs.peek()) };
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
  await set({ scenes: [named], index: 0, isVideo: false, isEdit: true, corrects: object });
  const open = draft.peek();
  if (open?.corrects === undefined) return;
  // They concern the scene as it is shown.
  for (const { message } of open.problems) seenDoubts.add(message);
  marked.value = object;
}

/** Gives an object of the scene that is shown another mask, and aligns it alone. One step undoes both. */
async function correctShown(object: ObjectModel, mask: Uint8Array, corrected: Inputs): Promise<void> {
  const { depthM: data, width, camera } = scene.peek() as Scene;
  const step = record(object, () => {
    object.shape.value = mask;
    object.visible.value = visibleExtent({ data, width }, mask, camera);
    // What was said of the pose before says nothing of the new mask.
    object.pose.value = object.isPlaced ? { ...object.pose.peek(), alignment: null } : object.start.peek();
    object.decision.value = null;
    amend((now) => (video.peek() === null ? withId(corrected) : { ...corrected, name: now.name }));
  });
  select(object.id);
  await alignSelected(page);
  join(step);
}

/** Whether inputs differ from those that are shown by the mask of one object only. */
function isCorrected(next: Inputs, index: number): boolean {
  const now = inputs.peek();
  const isSame = (name: keyof Inputs) => now[name] === next[name];
  return (
    (["depth", "depthKind", "depthScale", "photo", "camera", "imageId", "resizeMasks"] as const).every(isSame) &&
    now.objects.length === next.objects.length &&
    next.objects.every(({ mask, mesh }, i) => {
      const before = now.objects[i];
      return before?.mesh === mesh && (i === index || before?.mask === mask);
    })
  );
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

/** Changes names in the draft, for which nothing has to be read. */
export function label(apply: (inputs: Inputs) => Inputs): void {
  const open = draft.peek();
  if (open === null) return;
  draft.value = { ...open, scenes: open.scenes.map((one, i) => (i === open.index ? apply(one) : one)) };
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

/** Inputs without empty names, and with a name that no other scene has. */
function named(of: Inputs): Inputs {
  const own = of.name.trim() || OWN_FILES;
  const isTaken = (name: string) => list.peek().some(({ inputs }) => inputs.name === name && inputs.id !== of.id);
  let name = own;
  for (let i = 2; isTaken(name); i++) name = `${own} ${i}`;
  return { ...of, name, objects: of.objects.map((one) => ({ ...one, name: one.name.trim() || "Object" })) };
}

/** Makes the draft the scene that is shown, and aligns it. */
export async function accept(): Promise<void> {
  const open = draft.peek();
  if (open === null || !isReady(open) || open.reading === null) return;
  const inputs = named(draftInputs(open));
  const { corrects = -1 } = open;
  const [object, mask] = [objects.peek()[corrects], open.reading.objects[corrects]?.mask];
  const isCorrection = object !== undefined && mask != null && isCorrected(inputs, corrects);
  const opened = sceneOf(inputs, open.reading);
  if (opened === null) return;
  lastChange++;
  draft.value = null;
  for (const { message } of open.problems) seenDoubts.add(message);
  if (isCorrection) return correctShown(object, mask, inputs);
  if (open.isVideo) {
    const listed = named(asListed(open.scenes));
    // Also while its first frame is read, it is not forgotten.
    enlist([listed]);
    // Tracking starts with the first frame, whichever is looked at.
    if (!(await openVideo(listed))) {
      draft.value = draft.peek() ?? open;
      return announce("The first frame could not be read.", "failed");
    }
    await trackAll();
    return;
  }
  // A frame of a video with other files is a scene of its own.
  const isFrame = open.isEdit && video.peek() !== null;
  const scenes = open.scenes.map((one) =>
    one.sample === null ? withId({ ...named(one), ...(isFrame && { id: "" }) }) : one,
  );
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

/** Makes the scene of the draft anew from its files. */
export async function rebuild(files: readonly Typed[]): Promise<void> {
  const open = draft.peek();
  if (open !== null) await change(() => rebuilt(draftInputs(open), files), true);
}

export async function set(next: Omit<Draft, "reading" | "problems" | "progress">, opens = true): Promise<void> {
  const change = ++lastChange;
  draft.value = { ...next, reading: null, problems: [], progress: { done: 0, total: 0 } };
  const inputs = next.scenes[next.index] as Inputs;
  // Names may be typed meanwhile.
  const update = (more: Partial<Draft>) => {
    if (draft.peek() !== null) draft.value = { ...(draft.peek() as Draft), ...more };
  };
  const reading = await readInputs(inputs, (progress) => change === lastChange && update({ progress }));
  if (change !== lastChange) return;
  const problems = problemsOf(inputs, reading);
  update({ reading, problems });
  announce(problems[0]?.message ?? `${inputs.name} can be opened.`, problems.length > 0 ? "failed" : "done");
  const isWhole = problems.length === 0 && (next.scenes.length === 1 || next.isVideo);
  if (opens && isWhole && !next.isEdit && !hasWork()) await accept();
}

/** Whether the sample that is shown has poses that were set by hand: unlike the user's own scenes, it is not kept. */
const hasWork = () =>
  scene.peek()?.sample !== null && scene.peek()?.objects.some(({ pose }) => pose.peek().source === "hand") === true;

/** Shows what is wrong with the files as a whole. */
export function refuse(problem: Problem): void {
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
