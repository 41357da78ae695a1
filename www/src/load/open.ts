/** Opens scenes: samples, and a user's own files. */
import { signal } from "@preact/signals";
import { say } from "../state/announcement.js";
import { layers, setLayer } from "../state/display.js";
import { scene } from "../state/scene.js";
import { unpacked } from "./archive.js";
import { FieldError } from "./field-error.js";
import { assigned, type Field, type Inputs, kindOf, noInputs } from "./inputs.js";
import type { NamedFile } from "./named-file.js";
import { readScene } from "./read-scene.js";
import { type Sample, sampleInputs } from "./samples.js";

/** The inputs as they were chosen, whether or not they could be read. */
export const inputs = signal<Inputs>(noInputs);
/** What is wrong with the inputs, by field. */
export const fieldErrors = signal<{ readonly [F in Field]?: FieldError }>({});
export const isReading = signal(false);

/** Counts openings: a later one makes an earlier one's result worthless. */
let opening = 0;

/** Reads the inputs, and shows what they hold; a field that is wrong says so, and the scene stays as it was. */
export async function open(next: Inputs): Promise<boolean> {
  const turn = ++opening;
  inputs.value = next;
  fieldErrors.value = {};
  isReading.value = true;
  say(`Reading ${next.name} …`, "working");
  try {
    const read = await readScene(next);
    if (turn !== opening) return false;
    scene.value = read;
    if (read.rgba === null && layers.peek().base === "photo") setLayer("base", "depth");
    if (read.rgba !== null && layers.peek().base === "depth") setLayer("base", "photo");
    say(`${read.name}: ${read.width} × ${read.height} pixels, ${countOf(read.objects.length)}. Ready to align.`);
    return true;
  } catch (error) {
    if (turn !== opening) return false;
    const found = error instanceof FieldError ? error : new FieldError("depth", error);
    fieldErrors.value = { [found.field]: found };
    say(`${found.field}: ${found.message} ${found.remedy}`, "failed");
    return false;
  } finally {
    if (turn === opening) isReading.value = false;
  }
}

const countOf = (count: number) => (count === 1 ? "one object" : `${count} objects`);

export const openSample = (sample: Sample): Promise<boolean> => open(sampleInputs(sample));

/** Opens what was dropped or chosen: each file goes where its name says, or into the field that it was chosen for. */
export async function openFiles(files: readonly NamedFile[], field?: Field): Promise<boolean> {
  let all: readonly NamedFile[];
  try {
    all = await unpacked(files);
  } catch (error) {
    return fail(field ?? "depth", error);
  }
  if (field !== undefined && all.length === files.length) return open(intoField(field, all, inputs.peek()));
  if (!all.some(({ path }) => kindOf(path) !== null)) {
    const names = all.slice(0, 3).map(({ path }) => path);
    return fail("depth", new Error(`Nothing to align among the files (${names.join(", ") || "none"}).`));
  }
  return open(assigned(all, inputs.peek()));
}

function fail(field: Field, error: unknown): boolean {
  const found = new FieldError(field, error);
  fieldErrors.value = { [field]: found };
  say(found.message, "failed");
  return false;
}

function intoField(field: Field, files: readonly NamedFile[], present: Inputs): Inputs {
  const [file] = files;
  if (file === undefined) return present;
  const own = { ...present, sample: null, name: present.sample === null ? present.name : "Own files" };
  if (field === "depth") return { ...own, depth: file };
  if (field === "photo") return { ...own, photo: file };
  if (field === "camera") return { ...own, camera: { kind: "file", file } };
  if (field === "mask") return { ...own, masks: files, truths: [] };
  const meshes = files.filter(({ path }) => kindOf(path) === "mesh");
  return {
    ...own,
    meshes: (meshes.length > 0 ? meshes : files).map((mesh) => ({ file: mesh, beside: files })),
    truths: [],
  };
}
