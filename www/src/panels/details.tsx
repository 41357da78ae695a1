/** Details of the result: all metrics, the pose, and what the numbers mean. */
import type { ObjectModel } from "../state/object-model.js";
import { isResult } from "../state/pose.js";
import { metricTexts } from "../ui/metric-texts.js";
import { orDash, overlapText, significant, small } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";
import { quietWarningsOf } from "./advised.js";
import { inputRows } from "./input-rows.js";
import { MetricTable } from "./result-panel.js";

export function Details({ object }: { object: ObjectModel | null }) {
  return (
    <details class="more details">
      <summary>Details</summary>
      <MetricTable object={object} metrics={metricTexts} id="more-metrics" />
      <Pose object={object} />
      {object !== null &&
        quietWarningsOf(object).map(({ code, message }) => (
          <p key={code} class="quiet">
            {message}
          </p>
        ))}
      <Meanings />
    </details>
  );
}

/** What the numbers of a result mean. */
const meanings: readonly (readonly [title: string, text: string])[] = [
  [
    "Confidence",
    "Probability that the pose is correct: scale within 5 %, rotation within 10°, position within 5 % of the object's size. It is calibrated on generated cases and assumes that the mesh is that of the object.",
  ],
  [
    "Alternatives",
    "Other poses that explain the observation nearly as well, best first. Objects that look similar from several sides have several. The angle is the rotation from the result.",
  ],
  ...[overlapText, ...metricTexts].map(
    ({ title, about, better }) =>
      [title, `${about} ${better === "higher" ? "Higher is better." : "Lower is better."}`] as const,
  ),
];

const Meanings = () => (
  <details class="more meanings">
    <summary>What the numbers mean</summary>
    <dl>
      {meanings.map(([title, text]) => (
        <div key={title}>
          <dt>{title}</dt>
          <dd>{text}</dd>
        </div>
      ))}
    </dl>
  </details>
);

function Pose({ object }: { object: ObjectModel | null }) {
  const { scene, unit: shownUnit } = useWorkspace();
  const unit = shownUnit.value;
  const uncertainty = isResult(object?.pose.value.source) ? object?.precise?.uncertainty : null;
  // One standard deviation.
  const within = (text: string | null | undefined) => (text ? ` ± ${text}` : "");
  const transform = object?.pose.value.transform;
  const list = (numbers: readonly number[] | undefined) => numbers?.map((x) => x.toFixed(3)).join(", ") ?? "–";
  const scale = orDash(transform?.scale, (s) => significant(s / (unit ?? 1), 5));
  const centre = list(object?.box.value.centreM.map((x) => x / (unit ?? 1)));
  const rows = [
    [
      "Scale",
      `${scale} ${unit === null ? "m " : ""}per mesh unit${within(uncertainty && `${significant(100 * uncertainty.scale, 2)} %`)}`,
    ],
    ["Centre", `${centre}${unit === null ? " m" : ""}${within(uncertainty && small(uncertainty.distanceM, unit))}`],
    ["Rotation", `${list(transform?.rotation)}${within(uncertainty && `${significant(uncertainty.rotationDeg, 2)}°`)}`],
    ...(scene.value === null ? [] : inputRows(scene.value)),
    ["Time", orDash(object?.alignment.value?.diagnostics.timingsMs.total, (ms) => `${Math.round(ms)} ms`)],
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
