/** The camera: a file, its numbers, or a guess. */
import { baseName } from "../load/named-file.js";
import { inputs, open } from "../load/open.js";
import { scene } from "../state/scene.js";
import { significant } from "../ui/format.js";
import { FileField } from "./file-field.js";

const numbers = ["fx", "fy", "cx", "cy"] as const;

/** What most phones and laptops have, vertically. */
const GUESS_DEG = 50;

function setNumber(name: (typeof numbers)[number], value: number): void {
  const present = scene.peek()?.camera;
  const known = inputs.peek().camera;
  const before = known?.kind === "numbers" ? known : (present ?? { fx: 500, fy: 500, cx: 320, cy: 240 });
  const { fx, fy, cx, cy } = before;
  open({ ...inputs.peek(), camera: { kind: "numbers", ...{ fx, fy, cx, cy }, [name]: value } });
}

export function CameraField() {
  const { camera } = inputs.value;
  const shown = scene.value?.camera;
  const chosen =
    camera?.kind === "file"
      ? baseName(camera.file.path)
      : camera?.kind === "guess"
        ? `a guess, ${camera.fovYDeg}°`
        : camera?.kind === "numbers"
          ? "as typed"
          : "";
  return (
    <FileField field="camera" title="Camera" chosen={chosen} accept=".json,.yaml,.yml">
      <details class="more sub">
        <summary>Numbers, or a guess</summary>
        <div class="camera-numbers">
          {numbers.map((name) => (
            <label key={name} class="field-inline">
              <span>{name}</span>
              <input
                id={`camera-${name}`}
                type="number"
                step="any"
                inputMode="decimal"
                value={shown === undefined ? "" : significant(shown[name], 7)}
                onChange={({ currentTarget }) => setNumber(name, currentTarget.valueAsNumber)}
              />
            </label>
          ))}
          <label class="field-inline wide">
            <span>Field of view, vertical</span>
            <input
              id="camera-fov"
              type="number"
              min="1"
              max="170"
              step="any"
              inputMode="decimal"
              placeholder={`${GUESS_DEG}`}
              value={camera?.kind === "guess" ? camera.fovYDeg : ""}
              onChange={({ currentTarget: { valueAsNumber } }) =>
                open({ ...inputs.peek(), camera: { kind: "guess", fovYDeg: valueAsNumber || GUESS_DEG } })
              }
            />
            <span class="unit">°</span>
          </label>
        </div>
        <p class="quiet">A guessed field of view makes the size a guess: measure the camera where the size matters.</p>
      </details>
    </FileField>
  );
}
