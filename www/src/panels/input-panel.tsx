/** The input files of the scene that is shown. */
import { baseName } from "../load/files.js";
import { editInputs, openNext, openSample } from "../load/open.js";
import { samples } from "../load/samples.js";
import { alignAll } from "../run/align.js";
import { page } from "../state/page.js";

const { inputs, queue, scene } = page;

/** Forgets the scene, and shows the first sample again. */
async function forget(): Promise<void> {
  const [first] = samples;
  await (await import("../session/index.js")).forgetSession();
  if (first !== undefined && (await openSample(first))) await alignAll(page);
}

const unknownCamera = { file: "–", numbers: "entered", assumed: "assumed" };

export function InputPanel() {
  const { depth, camera, photo, objects } = inputs.value;
  const whole = scene.value;
  const rows = [
    ["Depth map", depth === null ? "–" : baseName(depth.path)],
    [
      "Camera",
      camera === null ? "–" : camera.kind === "file" ? baseName(camera.file.path) : unknownCamera[camera.kind],
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
      {queue.value.length > 0 && (
        <button type="button" id="next-scene" onClick={openNext}>
          Next scene ({queue.value.length} left)
        </button>
      )}
    </details>
  );
}
