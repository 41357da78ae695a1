/** The input files of the scene that is shown. */
import { unitText } from "sim3align/input/depth-kinds";
import { baseName } from "../input/files.js";
import { editInputs } from "../opening/open.js";
import { page } from "../state/page.js";
import type { Scene } from "../state/scene.js";

const { framePoses, frameWorks, inputs, objects, scene, unit } = page;

/** Forgets the scene. What a person has decided, set or drawn is not forgotten unasked. */
async function forget(): Promise<void> {
  const { name, objects: pairs } = inputs.peek();
  const isSet = objects.peek().some(({ verdict, pose }) => verdict.peek() !== null || pose.peek().source === "hand");
  const isDrawn = pairs.some(({ mask }) => mask?.isDrawn === true);
  const isInFrames = frameWorks.peek().some(Boolean) || framePoses.peek().some((one) => one?.isCorrected === true);
  if ((isSet || isDrawn || isInFrames) && !confirm(`Forget ${name}, with what you have set, accepted and drawn?`))
    return;
  await (await import("../session/index.js")).forgetScene();
}

const unknownCamera = { file: "–", numbers: "entered", assumed: "assumed" };

export function InputPanel() {
  const { depth, camera, photo, objects: pairs } = inputs.value;
  const whole = scene.value;
  const source = whole?.cameraSource === "estimate" ? "estimated" : (whole?.cameraSource ?? "–");
  const rows = [
    ["Depth map", depth === null ? "–" : baseName(depth.path)],
    ["Unit", whole === null ? "–" : unitOf(whole)],
    [
      "Camera",
      camera === null ? source : camera.kind === "file" ? baseName(camera.file.path) : unknownCamera[camera.kind],
    ],
    ["Photo", photo === null ? "–" : baseName(photo.path)],
    ["Objects", pairs.map(({ name }) => name).join(", ")],
  ] as const;
  return (
    <details class="panel input-panel" style={{ gridArea: "input" }} id="inputs">
      <summary>
        <h2>Files</h2>
        {/* A wrong unit makes every size wrong, so it is said at all times. */}
        {whole !== null && <span class="quiet">Unit: {unitOf(whole)}</span>}
      </summary>
      {whole !== null && (
        <>
          <dl class="facts">
            {rows.map(([title, text]) => (
              <div key={title}>
                <dt>{title}</dt>
                <dd title={text}>{text}</dd>
              </div>
            ))}
          </dl>
          <div class="row">
            <button type="button" id="edit-files" onClick={editInputs}>
              Change or add …
            </button>
            {whole.sample === null && (
              <button
                type="button"
                id="forget"
                title="Closes the scene, and forgets it in this browser"
                onClick={forget}
              >
                Forget
              </button>
            )}
          </div>
        </>
      )}
    </details>
  );
}

/** The unit of the depth map, in plain words. */
function unitOf({ depthUnit, raw }: Scene): string {
  if (raw === null || raw.depthKind === "metric") return unitText(depthUnit);
  return unit.value === null ? "from a known size" : "none: sizes are relative";
}
