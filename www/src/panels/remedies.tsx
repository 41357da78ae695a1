/** What helps if a result is unsure, beside the result instead of in an explanation. */
import { alignSelected } from "../alignment/align.js";
import { fix } from "../commands/decisions.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Options } from "../state/options.js";
import { SURE } from "../state/progress.js";
import { useWorkspace } from "../ui/workspace.js";
import { KnownSize } from "./known-size.js";

const ups: readonly (readonly [Options["up"], string])[] = [
  ["y", "y is up"],
  ["z", "z is up"],
];

export function Remedies({ object }: { object: ObjectModel | null }) {
  const workspace = useWorkspace();
  const { isRunning, options, setOption } = workspace;
  const isAsked = (object?.confidence ?? 1) < SURE;
  if (object === null || !isAsked || object.verdict.value !== null) return null;
  const alternatives = object.precise?.alternatives.length ?? 0;
  const align = (change: () => void) => () => {
    change();
    alignSelected(workspace);
  };
  return (
    <div class="stack note remedies">
      <p>Not sure. {alternatives > 0 ? "Choose a pose below, or say what you know:" : "Say what you know:"}</p>
      <KnownSize object={object} id="remedy-size" />
      <fieldset class="row" disabled={isRunning.value}>
        <legend>It stands upright, and the camera was level</legend>
        {ups.map(([up, title]) => (
          <button
            key={up}
            type="button"
            aria-pressed={options.value.up === up}
            onClick={align(() => setOption("up", options.peek().up === up ? "unknown" : up))}
          >
            {title}
          </button>
        ))}
      </fieldset>
      <p>
        Or move it roughly into place, then refine.{" "}
        <button type="button" onClick={(event) => fix(workspace, event)}>
          Move by hand
        </button>
      </p>
    </div>
  );
}
