/** Masks that are marked on the photo of a draft. */
import { useMemo } from "preact/hooks";
import { type Draft, draftInputs, marked } from "../input/draft.js";
import { colourOf } from "../input/reading.js";
import { maskFile } from "../masking/mask-file.js";
import type { Mark } from "../masking/strokes.js";
import type { Inputs, NamedFile, ObjectFiles } from "../state/inputs.js";
import { lazy } from "../ui/lazy.js";
import { acceptIfClear, change, dismiss } from "./draft.js";

/** How masks were made that were made here, for going on with them: the mask before, and the marks on it. */
const made = new WeakMap<NamedFile, { before: Uint8Array | null; marks: readonly Mark[] }>();

const begunWith = (file: NamedFile | undefined, mask: Uint8Array | null) =>
  (file && made.get(file)) ?? { before: mask, marks: [] };

const MaskEditor = lazy(
  () => marked.value !== null,
  () => import("../masking/editor.js").then(({ MaskEditor }) => MaskEditor),
);

/** A button that marks an object on the photo or, without one, on the depth map. */
export const MarkButton = ({ i, title, id }: { i: number; title: string; id?: string }) => (
  <button
    type="button"
    id={id}
    onClick={() => {
      marked.value = i;
    }}
  >
    {title}
  </button>
);

export function Marking({ open, ground }: { open: Draft; ground: Uint8ClampedArray | null }) {
  const i = marked.value;
  const { reading } = open;
  const { shown = null, depth = null, size = null } = reading ?? {};
  const view = useMemo(
    () => ground && shown && { ...shown, rgba: ground, depth: depth?.data ?? null },
    [ground, shown, depth],
  );
  if (i === null || view === null || shown === null || size === null) return null;
  const inputs = draftInputs(open);
  const { name, mask } = inputs.objects[i] ?? { name: "Object", mask: null };
  const close = () => {
    marked.value = null;
  };
  return (
    <MaskEditor
      {...{ name, view }}
      colour={colourOf(i)}
      {...begunWith(mask?.file, reading?.objects[i]?.mask ?? null)}
      onCancel={() => {
        close();
        if (open.corrects !== undefined) dismiss();
      }}
      onDone={async (drawn, marks) => {
        const file = await maskFile(drawn, shown, size, name);
        const { before } = begunWith(mask?.file, reading?.objects[i]?.mask ?? null);
        made.set(file, { before, marks });
        close();
        await change(withMask(i, file), true);
        if (open.corrects !== undefined) await acceptIfClear();
      }}
    />
  );
}

/** Gives an object a mask, or makes an object of it. */
const withMask =
  (i: number, file: NamedFile) =>
  (inputs: Inputs): Inputs => {
    const before = inputs.objects[i];
    const object: ObjectFiles = before ?? { name: "Object", mask: null, mesh: null, truth: null };
    const objects = [...inputs.objects];
    objects[i] = { ...object, mask: { file, isDrawn: true } };
    const files = inputs.files.filter((one) => one.file !== before?.mask?.file);
    return { ...inputs, objects, files: [...files, { file, role: "mask" }] };
  };
