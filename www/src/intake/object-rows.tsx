/** The objects of a draft: each mask with its mesh. Meshes are paired anew by selecting or dragging. */
import { useMemo } from "preact/hooks";
import { meshResources } from "sim3align/input/formats";
import { type Draft, draftInputs } from "../input/draft.js";
import { baseName } from "../input/files.js";
import { photoExtensions } from "../input/photo.js";
import { withoutObject } from "../input/problems.js";
import { colourOf, type ReadObject } from "../input/reading.js";
import { maskThumbnail, meshThumbnail } from "../pictures/thumbnails.js";
import type { Inputs, MeshSource, ObjectFiles } from "../state/inputs.js";
import { Check, Choices, Picture } from "../ui/controls.js";
import { acceptOf, FieldFiles } from "./cards.js";
import { change, label } from "./draft.js";
import { MarkButton } from "./marking.js";
import { Problems, problemsFor } from "./problem-list.js";

/** Width and height of a thumbnail in pixels. */
const SIZE = 112;

/** The files of objects, with the other extensions that are accepted. */
const files = [
  { field: "mask", title: "Masks", beside: photoExtensions },
  { field: "mesh", title: "Meshes", beside: meshResources },
] as const;

const emptyObject: ReadObject = { mask: null, mesh: null, glb: null, truth: null };

export function ObjectRows({ open, ground }: { open: Draft; ground: Uint8ClampedArray | null }) {
  const inputs = draftInputs(open);
  const isWrong = (field: "mask" | "mesh") => problemsFor(field).some(({ kind }) => kind === "error");
  return (
    <section class="pairs" aria-labelledby="pairs-title">
      <div class="row card-head">
        <h3 id="pairs-title">Objects: mask and mesh</h3>
        {files.map(({ field, title, beside }) => (
          <span class="field-inline" key={field}>
            <span>{title}</span>
            <FieldFiles
              field={field}
              title={title}
              accept={acceptOf(field, beside)}
              isWrong={isWrong(field)}
              multiple
            />
          </span>
        ))}
      </div>
      <div data-field="mask" data-wrong={isWrong("mask")}>
        <Problems field="mask" general />
        <Resize open={open} />
      </div>
      <div data-field="mesh" data-wrong={isWrong("mesh")}>
        <Problems field="mesh" general />
      </div>
      <ul class="stack">
        {inputs.objects.map((object, i) => (
          <Row
            key={`${i} ${object.mask?.file.path}`}
            {...{ inputs, object, i, ground }}
            read={open.reading?.objects[i] ?? emptyObject}
            width={open.reading?.shown?.width ?? 1}
          />
        ))}
      </ul>
      {ground !== null && !inputs.objects.some(({ mask }) => mask !== null) && (
        <MarkButton i={0} id="mark-mask" title={`Mark it on the ${open.reading?.photo ? "photo" : "depth map"}`} />
      )}
    </section>
  );
}

/** Masks of another size than the depth map can be resized. */
function Resize({ open }: { open: Draft }) {
  const { resizeMasks } = draftInputs(open);
  const isNeeded = resizeMasks || open.problems.some(({ field, code }) => field === "mask" && code === "SIZE_MISMATCH");
  if (!isNeeded) return null;
  return (
    <Check
      id="resize-masks"
      title="Resize masks to the depth map"
      checked={resizeMasks}
      onCheck={(checked) => change((now) => ({ ...now, resizeMasks: checked }), true)}
    />
  );
}

interface RowProps {
  inputs: Inputs;
  object: ObjectFiles;
  read: ReadObject;
  i: number;
  ground: Uint8ClampedArray | null;
  width: number;
}

function Row({ inputs, object, read, i, ground, width }: RowProps) {
  const { mask, mesh } = read;
  const colour = colourOf(i);
  const seen = useMemo(
    () => (mask === null ? null : maskThumbnail(ground, mask, width, SIZE, colour)),
    [mask, ground, width, colour],
  );
  const shape = useMemo(() => (mesh === null ? null : meshThumbnail(mesh, SIZE, colour)), [mesh, colour]);
  const rename = (name: string) =>
    label((now) => ({
      ...now,
      objects: now.objects.map((one, k) => (k === i ? { ...one, name } : one)),
    }));
  const triangles = mesh === null ? null : mesh.indices.length / 3;
  return (
    <li
      class="pair"
      data-object={object.name}
      onDragOver={(event) => event.dataTransfer?.types.includes(DRAGGED) && event.preventDefault()}
      onDrop={(event) => {
        const from = event.dataTransfer?.getData(DRAGGED);
        if (from === undefined || from === "") return;
        event.preventDefault();
        const dropped = inputs.objects[Number(from)]?.mesh;
        if (dropped != null) change(withMesh(i, dropped));
      }}
    >
      <Picture image={seen} label={`Mask of ${object.name}`} />
      <div class="stack pair-mask">
        <input
          aria-label={`Name of object ${i + 1}`}
          value={object.name}
          onInput={({ currentTarget }) => rename(currentTarget.value)}
        />
        <span class="path" title={object.mask?.file.path}>
          {maskTitle(object)}
        </span>
        <span class="quiet">{read.maskReading && `Object: ${read.maskReading}`}</span>
        {ground !== null && <MarkButton i={i} title={mask === null ? "Mark" : "Mark again"} />}
      </div>
      <span class="arrow" aria-hidden="true">
        ↔
      </span>
      <fieldset
        class="draggable"
        aria-label={`Mesh of ${object.name}, to be dragged`}
        draggable={object.mesh !== null}
        onDragStart={(event) => event.dataTransfer?.setData(DRAGGED, `${i}`)}
      >
        <Picture image={shape} label={`Mesh for ${object.name}`} />
      </fieldset>
      <div class="stack pair-mask">
        <MeshSelect inputs={inputs} object={object} i={i} />
        <span class="quiet">{triangles !== null && `${triangles.toLocaleString("en-GB")} triangles`}</span>
      </div>
      <button type="button" aria-label={`Leave out ${object.name}`} onClick={() => change(withoutObject(i))}>
        ×
      </button>
      <div class="stack pair-problems">
        <Problems field="mask" object={i} />
        <Problems field="mesh" object={i} />
        <Problems field="depth" object={i} />
      </div>
    </li>
  );
}

/** The type of what is dragged: the index of the object whose mesh it is. */
const DRAGGED = "application/x-sim3align-mesh";

function maskTitle({ mask }: ObjectFiles): string {
  if (mask === null) return "no mask";
  return `${baseName(mask.file.path)}${mask.isInverted === true ? ", inverted" : ""}`;
}

function MeshSelect({ inputs: { meshes }, object, i }: { inputs: Inputs; object: ObjectFiles; i: number }) {
  const chosen = object.mesh === null ? -1 : meshes.indexOf(object.mesh);
  return (
    <Choices
      label={`Mesh of ${object.name}`}
      value={`${chosen}`}
      choices={[
        ["-1", "no mesh"],
        ...meshes.map(({ file }, k) => [`${k}`, file.path.split("/").slice(-2).join("/")] as const),
      ]}
      onChoose={(value) => change(withMesh(i, meshes[Number(value)] ?? null))}
    />
  );
}

/** Gives an object a mesh. If another object had it, both exchange theirs. */
const withMesh =
  (index: number, mesh: MeshSource | null) =>
  (inputs: Inputs): Inputs => {
    const before = inputs.objects[index]?.mesh ?? null;
    const other = mesh === null ? -1 : inputs.objects.findIndex((one, i) => i !== index && one.mesh === mesh);
    const objects = inputs.objects.map((one, i) =>
      i === index ? { ...one, mesh } : i === other ? { ...one, mesh: before } : one,
    );
    return { ...inputs, objects: objects.filter(({ mask, mesh }) => mask !== null || mesh !== null) };
  };
