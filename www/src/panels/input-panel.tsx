/** The input files of the scene that is shown. */
import { baseName } from "../load/files.js";
import { editInputs, isOpen, nextListed, openListed, openNext, openSample, progressOf } from "../load/open.js";
import { samples } from "../load/samples.js";
import { alignAll } from "../run/align.js";
import type { Listed } from "../state/opened.js";
import { page } from "../state/page.js";
import type { Scene } from "../state/scene.js";

const { inputs, list, othersScenes, scene, unit } = page;

/** Forgets the scene, and shows the next one or, without any, the first sample. */
async function forget(): Promise<void> {
  const [first] = samples;
  await (await import("../session/index.js")).forgetScene();
  if (list.peek().length > 0) await openNext();
  else if (first !== undefined && (await openSample(first))) await alignAll(page);
}

const unknownCamera = { file: "–", numbers: "entered", assumed: "assumed" };

export function InputPanel() {
  const { depth, camera, photo, objects } = inputs.value;
  const whole = scene.value;
  const source = whole?.cameraSource === "estimate" ? "estimated" : (whole?.cameraSource ?? "–");
  const rows = [
    ["Depth map", depth === null ? "–" : baseName(depth.path)],
    ["Unit", whole === null ? "–" : unitText(whole)],
    [
      "Camera",
      camera === null ? source : camera.kind === "file" ? baseName(camera.file.path) : unknownCamera[camera.kind],
    ],
    ["Photo", photo === null ? "–" : baseName(photo.path)],
    ["Objects", objects.map(({ name }) => name).join(", ")],
  ] as const;
  return (
    <details class="panel input-panel" id="inputs" open>
      <summary>
        <h2>Files</h2>
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
              Change …
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
      <Scenes />
    </details>
  );
}

/** The unit of the depth map, in plain words. */
function unitText({ depthUnit, raw }: Scene): string {
  if (raw === null || raw.depthKind === "metric") return depthUnit;
  return unit.value === null ? "from a known size" : "none: sizes are relative";
}

function stateOf(one: Listed): string {
  const progress = progressOf(one);
  if (progress === null) return "not opened";
  const { accepted, objects } = progress;
  return accepted === objects ? "✓ accepted" : `${accepted} of ${objects} accepted`;
}

/** The user's own scenes, if there are several, and those of other tabs. */
function Scenes() {
  const [all, others] = [list.value, othersScenes.value];
  const left = all.filter(isOpen).length;
  return (
    <>
      {all.length > 1 && (
        <>
          <ul class="scenes" aria-label="Your scenes">
            {all.map((one) => (
              <li key={one.inputs.id}>
                <button
                  type="button"
                  aria-pressed={one.inputs.id === inputs.value.id}
                  onClick={() => openListed(one.inputs)}
                >
                  <span class="listed">{one.inputs.name}</span> <span class="quiet">{stateOf(one)}</span>
                </button>
              </li>
            ))}
          </ul>
          <button type="button" id="next-scene" disabled={nextListed() === null} onClick={openNext}>
            Next scene ({left} left)
          </button>
        </>
      )}
      {others.length > 0 && (
        <p class="quiet" id="other-tabs">
          Another tab has {others.join(", ")} open. Each tab keeps its own scenes.
        </p>
      )}
    </>
  );
}
