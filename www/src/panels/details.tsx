/** Details of the result: all metrics, the pose and the times of the stages. */
import type { Stage } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import { Tip } from "../ui/controls.js";
import { orDash, significant } from "../ui/format.js";
import { type MetricText, metricTexts, stageTitles } from "../ui/texts.js";
import { quietWarningsOf } from "./sureness.js";

/** The metrics that are always shown. */
const MAIN = 3;

export const MainMetrics = ({ object }: { object: ObjectModel | null }) => (
  <MetricTable object={object} metrics={metricTexts.slice(0, MAIN)} id="metrics" />
);

export function Details({ object }: { object: ObjectModel | null }) {
  return (
    <details class="more details">
      <summary>Details</summary>
      <MetricTable object={object} metrics={metricTexts.slice(MAIN)} id="more-metrics" />
      <Pose object={object} />
      {object !== null &&
        quietWarningsOf(object).map(({ code, message }) => (
          <p key={code} class="quiet">
            {message}
          </p>
        ))}
      {object !== null && <StageTimes object={object} />}
    </details>
  );
}

interface MetricTableProps {
  object: ObjectModel | null;
  metrics: readonly MetricText[];
  id: string;
}

function MetricTable({ object, metrics: texts, id }: MetricTableProps) {
  const metrics = object?.metrics.value ?? null;
  return (
    <dl class="metrics" id={id}>
      {texts.map(({ name, title, about, better, show }) => (
        <div key={name}>
          <dt>
            {title}
            <Tip label={title}>
              {about} {better === "higher" ? "Higher is better." : "Lower is better."}
            </Tip>
          </dt>
          <dd data-metric={name} data-value={metrics?.[name] ?? ""}>
            {metrics === null ? (object === null ? "–" : "…") : orDash(metrics[name], show)}
          </dd>
        </div>
      ))}
    </dl>
  );
}

function Pose({ object }: { object: ObjectModel | null }) {
  const uncertainty = isResult(object?.pose.value.source) ? object?.precise?.uncertainty : null;
  // One standard deviation.
  const within = (value: number | undefined, unit: string) =>
    value === undefined ? "" : ` ± ${significant(value, 2)}${unit}`;
  const transform = object?.pose.value.transform;
  const list = (numbers: readonly number[] | undefined) => numbers?.map((x) => x.toFixed(3)).join(", ") ?? "–";
  const rows = [
    [
      "Scale",
      `${orDash(transform?.scale, (s) => significant(s, 5))} m per mesh unit${within(uncertainty ? 100 * uncertainty.scale : undefined, " %")}`,
    ],
    [
      "Centre",
      `${list(object?.box.value.centreM)} m${within(uncertainty ? 1000 * uncertainty.distanceM : undefined, " mm")}`,
    ],
    ["Rotation", `${list(transform?.rotation)}${within(uncertainty?.rotationDeg, "°")}`],
  ];
  return (
    <dl class="facts">
      {rows.map(([title = "", text]) => (
        <div key={title}>
          <dt>{title}</dt>
          <dd id={title.toLowerCase()}>{text}</dd>
        </div>
      ))}
    </dl>
  );
}

function StageTimes({ object }: { object: ObjectModel }) {
  const times = object.alignment.value?.diagnostics.timingsMs;
  if (times === undefined) return null;
  const stages = (Object.entries(times) as [Stage | "total", number][]).filter(
    (entry): entry is [Stage, number] => entry[0] !== "total" && entry[1] > 0,
  );
  const sum = stages.reduce((total, [, ms]) => total + ms, 0) || 1;
  return (
    <details class="stage-times">
      <summary>Took {Math.round(times.total)} ms</summary>
      <dl>
        {stages.map(([stage, ms]) => (
          <div key={stage}>
            <dt>{stageTitles[stage]}</dt>
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
