/** How long each stage took. */
import type { Stage } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import { stageNames } from "./run-bar.js";

export function StageTimes({ object }: { object: ObjectModel }) {
  const times = object.alignment.value?.timingsMs;
  if (times === undefined) return null;
  const stages = (Object.entries(times) as [Stage | "total", number][]).filter(
    (entry): entry is [Stage, number] => entry[0] !== "total" && entry[1] > 0,
  );
  const sum = stages.reduce((total, [, ms]) => total + ms, 0) || 1;
  return (
    <details class="times-of-stages">
      <summary>Took {Math.round(times.total)} ms</summary>
      <dl>
        {stages.map(([stage, ms]) => (
          <div key={stage}>
            <dt>{stageNames[stage]}</dt>
            <dd>
              <span class="bar" style={{ inlineSize: `${(100 * ms) / sum}%` }} />
              <span class="ms">{ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms</span>
            </dd>
          </div>
        ))}
      </dl>
    </details>
  );
}
