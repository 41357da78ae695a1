/** The camera: a file, intrinsics, or an assumed field of view. */
import { baseName } from "../load/files.js";
import { inputs, open } from "../load/open.js";
import { scene } from "../state/scene.js";
import { significant } from "../ui/format.js";
import { FileField } from "./file-field.js";

const intrinsics = ["fx", "fy", "cx", "cy"] as const;

/** A typical vertical field of view of phones and laptops. */
const ASSUMED_FOV_DEG = 50;

function setIntrinsic(name: (typeof intrinsics)[number], value: number): void {
  const { camera } = inputs.peek();
  const present = camera?.kind === "numbers" ? camera : scene.peek()?.camera;
  const { fx, fy, cx, cy } = present ?? { fx: 500, fy: 500, cx: 320, cy: 240 };
  open({ ...inputs.peek(), camera: { kind: "numbers", ...{ fx, fy, cx, cy }, [name]: value } });
}

export function CameraField() {
  const { camera } = inputs.value;
  const shown = scene.value?.camera;
  const chosen =
    camera?.kind === "file"
      ? baseName(camera.file.path)
      : camera?.kind === "assumed"
        ? `${camera.fovYDeg}° assumed`
        : camera?.kind === "numbers"
          ? "entered"
          : "";
  return (
    <FileField field="camera" title="Camera" chosen={chosen} accept=".json,.yaml,.yml">
      <details class="more sub">
        <summary>Enter or estimate intrinsics</summary>
        <div class="camera-numbers">
          {intrinsics.map((name) => (
            <label key={name} class="field-inline">
              <span>{name}</span>
              <input
                id={`camera-${name}`}
                type="number"
                step="any"
                inputMode="decimal"
                value={shown === undefined ? "" : significant(shown[name], 7)}
                onChange={({ currentTarget }) => setIntrinsic(name, currentTarget.valueAsNumber)}
              />
            </label>
          ))}
          <label class="field-inline wide">
            <span>Vertical field of view</span>
            <input
              id="camera-fov"
              type="number"
              min="1"
              max="170"
              step="any"
              inputMode="decimal"
              placeholder={`${ASSUMED_FOV_DEG}`}
              value={camera?.kind === "assumed" ? camera.fovYDeg : ""}
              onChange={({ currentTarget: { valueAsNumber } }) =>
                open({ ...inputs.peek(), camera: { kind: "assumed", fovYDeg: valueAsNumber || ASSUMED_FOV_DEG } })
              }
            />
            <span class="unit">°</span>
          </label>
        </div>
        <p class="quiet">
          With an assumed field of view, the size is approximate. Calibrate the camera if the size matters.
        </p>
      </details>
    </FileField>
  );
}
