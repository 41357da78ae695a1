/** Align, cancel, and how far it has come. */
import type { Stage } from "sim3align";
import { inputs, isReading } from "../load/open.js";
import { alignAll, alignSelected, cancel, fraction, isRunning } from "../run/align.js";
import { announcement } from "../state/announcement.js";
import { type Options, options, setOption } from "../state/options.js";
import { scene, selected } from "../state/scene.js";
import { Choices } from "../ui/choices.js";

/** What the stages do, for people. */
export const stageNames: { readonly [S in Stage]: string } = {
  observe: "Reading the depth",
  sample: "Sampling the mesh",
  normals: "Normals",
  features: "Descriptors",
  matching: "Matching",
  ransac: "Consensus",
  filter: "Filtering",
  icp: "Closest points",
  prepare: "Preparing",
  search: "Searching all rotations",
  refine: "Refining",
  metrics: "Measuring",
};

/** The choices of method and effort, as one list. */
const efforts: readonly [value: string, title: string, chosen: Pick<Options, "preset" | "quality">][] = [
  ["fast", "Fast", { preset: "precise", quality: "fast" }],
  ["balanced", "Balanced", { preset: "precise", quality: "balanced" }],
  ["best", "Best", { preset: "precise", quality: "best" }],
  ["paper", "Paper (baseline)", { preset: "paper", quality: "balanced" }],
];

function chooseEffort(value: string): void {
  const found = efforts.find(([name]) => name === value);
  if (found === undefined) return;
  setOption("preset", found[2].preset);
  setOption("quality", found[2].quality);
}

export function RunBar() {
  const { preset, quality } = options.value;
  const objects = scene.value?.objects ?? [];
  const awaited = isReading.value ? inputs.value.masks.length : 0;
  const running = isRunning.value;
  const run = selected.value?.run.value;
  const stage = run?.state === "running" && run.stage !== null ? stageNames[run.stage] : "";
  const { text, kind } = announcement.value;
  const percent = Math.round(100 * fraction.value);
  return (
    <section class="run" aria-label="Run">
      <div class="run-row">
        <label class="field-inline grow" for="effort">
          <span>Effort</span>
          <Choices
            id="effort"
            value={preset === "paper" ? "paper" : quality}
            choices={efforts.map(([value, title]) => [value, title] as const)}
            onChoose={chooseEffort}
          />
        </label>
        {running ? (
          <button type="button" id="cancel" class="primary" onClick={cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" id="align" class="primary" disabled={objects.length === 0} onClick={alignSelected}>
            Align
          </button>
        )}
        {Math.max(objects.length, awaited) > 1 && (
          <button type="button" id="align-all" disabled={running || objects.length === 0} onClick={alignAll}>
            Align all {Math.max(objects.length, awaited)}
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
      <div class="said">
        {/* Every stage would be too much to listen to: what is said aloud is the line below it. */}
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
