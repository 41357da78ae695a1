/** Align, cancel and progress. */
import { alignAll } from "../alignment/align.js";
import { stageTitles } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

export function RunBar() {
  const workspace = useWorkspace();
  const { fraction, isRunning, scene, selected, status, unpacking } = workspace;
  const opening = unpacking.value;
  const running = isRunning.value || opening !== null;
  const run = selected.value?.run.value;
  const stage = run?.state === "running" && run.stage !== null ? stageTitles[run.stage] : "";
  const { text, kind } = status.value;
  const percent = Math.round(100 * (opening?.share ?? fraction.value));
  return (
    <section class="run" style={{ gridArea: "run" }} part="run" aria-label="Run">
      <RunButton />
      <div class="status-lines">
        {/* Screen readers announce only the status line below; every stage would be too much. */}
        {running && (
          <p class="stage" aria-hidden="true">
            {opening !== null ? "Unpacking" : stage || "Waiting"} … {percent} %
          </p>
        )}
        <p id="status" class={running ? "behind" : ""} role="status" data-state={kind} title={text}>
          {text}
        </p>
      </div>
      <progress
        id="progress"
        max={100}
        value={running ? percent : kind === "done" && scene.value !== null ? 100 : 0}
        data-running={running}
        aria-label="Progress of the alignment"
      />
    </section>
  );
}

/** One button: it aligns what the scene has, and cancels that. One of several objects is aligned from its own menu. */
function RunButton() {
  const workspace = useWorkspace();
  const { cancel, inputs, isReading, isRunning, scene, unpacking } = workspace;
  const objects = scene.value?.objects ?? [];
  // While a scene is being read, the button is that of its objects already, so that the layout does not shift.
  const count = Math.max(objects.length, isReading.value ? inputs.value.objects.length : 0);
  if (isRunning.value || unpacking.value !== null) {
    return (
      <button type="button" id="cancel" class="primary" onClick={unpacking.value?.cancel ?? cancel}>
        Cancel
      </button>
    );
  }
  return (
    <button
      type="button"
      id={count > 1 ? "align-all" : "align"}
      class={objects.length > 0 && objects.every(({ isPlaced }) => isPlaced) ? "" : "primary"}
      disabled={objects.length === 0}
      onClick={() => alignAll(workspace)}
    >
      {count > 1 ? `Align all ${count}` : "Align"}
    </button>
  );
}
