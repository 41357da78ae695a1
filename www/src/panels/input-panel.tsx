/** The input files. */
import { useEffect, useRef } from "preact/hooks";
import { baseName, filesOf } from "../load/files.js";
import { fieldErrors, inputs, open, openFiles } from "../load/open.js";
import { Choices } from "../ui/controls.js";
import { CameraField } from "./camera-field.js";
import { FileField } from "./file-field.js";

/** Metres per unit of depth, as text. An empty text is the default of the reader. */
const depthUnits = [
  ["", "Auto"],
  ["1", "metres"],
  ["0.001", "millimetres"],
  ["0.0001", "0.1 mm"],
  ["0.00025", "0.25 mm"],
] as const;

const names = (files: readonly { path: string }[]) => files.map(({ path }) => baseName(path)).join(", ");

export function InputPanel() {
  const panel = useRef<HTMLDetailsElement>(null);
  const errors = fieldErrors.value;
  // Errors must be visible, however far the panel is scrolled.
  useEffect(() => {
    const wrong = panel.current?.querySelector('[data-wrong="true"]');
    if (panel.current === null || wrong === null || wrong === undefined) return;
    panel.current.open = true;
    wrong.scrollIntoView({ block: "nearest" });
  }, [errors]);
  const { depth, masks, meshes, photo, depthScale, resizeMasks } = inputs.value;
  return (
    <details class="panel input-panel" id="inputs" open ref={panel}>
      <summary>
        <h2>Input</h2>
      </summary>
      <p class="quiet">Drop files, a folder or a zip archive anywhere. They stay on this device.</p>
      <div class="row">
        <label class="button">
          <span>Open folder</span>
          <input
            id="folder"
            class="visually-hidden"
            type="file"
            {...{ webkitdirectory: true }}
            onChange={({ currentTarget }) => openFiles(filesOf(currentTarget))}
          />
        </label>
        <label class="button">
          <span>Open zip or files</span>
          <input
            id="files"
            class="visually-hidden"
            type="file"
            multiple
            onChange={({ currentTarget }) => openFiles(filesOf(currentTarget))}
          />
        </label>
      </div>
      <FileField field="depth" title="Depth" chosen={depth === null ? "" : baseName(depth.path)} accept=".png,.npy">
        <label class="field-inline sub" for="depth-scale">
          <span>Unit</span>
          <Choices
            id="depth-scale"
            value={`${depthScale ?? ""}` as (typeof depthUnits)[number][0]}
            choices={depthUnits}
            onChoose={(value) => open({ ...inputs.peek(), depthScale: value === "" ? null : Number(value) })}
          />
        </label>
      </FileField>
      <FileField field="mask" title="Mask" chosen={names(masks)} accept=".png,.npy,.json" multiple>
        <label class="check sub">
          <input
            type="checkbox"
            checked={resizeMasks}
            onChange={({ currentTarget }) => open({ ...inputs.peek(), resizeMasks: currentTarget.checked })}
          />
          <span>Resize masks</span>
        </label>
      </FileField>
      <FileField
        field="mesh"
        title="Mesh"
        chosen={names(meshes.map(({ file }) => file))}
        accept=".glb,.gltf,.obj,.ply,.stl,.bin"
        multiple
      />
      <CameraField />
      <FileField
        field="photo"
        title="Photo"
        chosen={photo === null ? "" : baseName(photo.path)}
        accept="image/png,image/jpeg,image/webp"
      />
    </details>
  );
}
