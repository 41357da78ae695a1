/** Align, cancel and progress. */
import { alignAll, alignSelected } from "../run/align.js";
import { stageTitles } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

export function RunBar() {
  const workspace = useWorkspace();
  const { cancel, fraction, inputs, isReading, isRunning, scene, selected, status } = workspace;
  const objects = scene.value?.objects ?? [];
  // While a scene is being read, the buttons are those of its objects already, so that the layout does not shift.
  const count = Math.max(objects.length, isReading.value ? inputs.value.objects.length : 0);
  const running = isRunning.value;
  const run = selected.value?.run.value;
  const stage = run?.state === "running" && run.stage !== null ? stageTitles[run.stage] : "";
  const { text, kind } = status.value;
  const percent = Math.round(100 * fraction.value);
  return (
    <section class="run" part="run" aria-label="Run">
      <div class="run-row">
        {running ? (
          <button type="button" id="cancel" class="primary" onClick={cancel}>
            Cancel
          </button>
        ) : (
          <button
            type="button"
            id="align"
            class={count > 1 ? "" : "primary"}
            disabled={objects.length === 0}
            onClick={() => alignSelected(workspace)}
          >
            Align
          </button>
        )}
        {count > 1 && (
          <button
            type="button"
            id="align-all"
            class={objects.length > 0 && objects.every(({ isPlaced }) => isPlaced) ? "" : "primary"}
            disabled={running || objects.length === 0}
            onClick={() => alignAll(workspace)}
          >
            Align all {count}
          </button>
        )}
      </div>
      <progress
        id="progress"
        max={100}
        value={running ? percent : kind === "done" ? 100 : 0}
        data-running={running}
        aria-label="Progress of the alignment"
      />
      <div class="status-lines">
        {/* Screen readers announce only the status line below; every stage would be too much. */}
        {running && (
          <p class="stage" aria-hidden="true">
            {stage || "Waiting"} … {percent} %
          </p>
        )}
        <p id="status" class={running ? "behind" : ""} role="status" data-state={kind} title={text}>
          {text}
        </p>
      </div>
    </section>
  );
}
