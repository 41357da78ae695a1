/** Opens scenes: samples and the user's own files. */
import { signal } from "@preact/signals";
import { layers, setLayer } from "../state/display.js";
import { scene } from "../state/scene.js";
import { announce } from "../state/status.js";
import { FieldError } from "./field-error.js";
import { extractArchives, type NamedFile } from "./files.js";
import { assignFiles, type Field, type Inputs, kindOf, noInputs } from "./inputs.js";
import { readScene } from "./read-scene.js";
import { type Sample, sampleInputs } from "./samples.js";

/** The chosen inputs, readable or not. */
export const inputs = signal<Inputs>(noInputs);
/** Errors of the inputs, by field. */
export const fieldErrors = signal<{ readonly [F in Field]?: FieldError }>({});
export const isReading = signal(false);

/** The number of the last call of `open`. The results of earlier calls are discarded. */
let lastCall = 0;

/** Reads the inputs and shows them. On failure, the field shows the error and the scene is unchanged. */
export async function open(next: Inputs): Promise<boolean> {
  const call = ++lastCall;
  inputs.value = next;
  fieldErrors.value = {};
  isReading.value = true;
  announce(`Reading ${next.name} …`, "working");
  try {
    const opened = await readScene(next);
    if (call !== lastCall) return false;
    scene.value = opened;
    if (opened.rgba === null && layers.peek().base === "photo") setLayer("base", "depth");
    if (opened.rgba !== null && layers.peek().base === "depth") setLayer("base", "photo");
    announce(
      `${opened.name}: ${opened.width} × ${opened.height} pixels, ${countOf(opened.objects.length)}. Ready to align.`,
    );
    return true;
  } catch (error) {
    if (call !== lastCall) return false;
    return fail(error instanceof FieldError ? error : new FieldError("depth", error));
  } finally {
    if (call === lastCall) isReading.value = false;
  }
}

const countOf = (count: number) => (count === 1 ? "one object" : `${count} objects`);

export const openSample = (sample: Sample): Promise<boolean> => open(sampleInputs(sample));

/** Opens files. Without a field, they are assigned by their names. */
export async function openFiles(files: readonly NamedFile[], field?: Field): Promise<boolean> {
  let extracted: readonly NamedFile[];
  try {
    extracted = await extractArchives(files);
  } catch (error) {
    return fail(new FieldError(field ?? "depth", error));
  }
  const hasArchive = extracted.length !== files.length;
  if (field !== undefined && !hasArchive) return open(withField(field, extracted, inputs.peek()));
  if (!extracted.some(({ path }) => kindOf(path) !== null)) {
    const names = extracted.slice(0, 3).map(({ path }) => path);
    const error = new Error(`None of the files is an input (${names.join(", ") || "no files"}).`);
    return fail(new FieldError("depth", error));
  }
  return open(assignFiles(extracted, inputs.peek()));
}

function fail(error: FieldError): false {
  fieldErrors.value = { [error.field]: error };
  announce(`${error.field}: ${error.message} ${error.remedy}`, "failed");
  return false;
}

/** The inputs with the files of one field replaced. */
function withField(field: Field, files: readonly NamedFile[], present: Inputs): Inputs {
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
    meshes: (meshes.length > 0 ? meshes : files).map((mesh) => ({ file: mesh, siblings: files })),
    truths: [],
  };
}
