/**
 * The result: size, confidence, alternatives, metrics and pose. Everything takes its space before there is a result, so
 * that the layout does not shift.
 */
import type { PoseErrors, Stage } from "sim3align";
import { inputs } from "../load/open.js";
import { applyAlternative, shownAlternative } from "../run/alternatives.js";
import type { ObjectModel } from "../state/object-model.js";
import { scene, selected } from "../state/scene.js";
import { Tip } from "../ui/controls.js";
import { centimetres, orDash, percent, significant } from "../ui/format.js";
import { metricTexts, stageTitles } from "../ui/texts.js";

export function ResultPanel() {
  const chosen = selected.value;
  const run = chosen?.run.value;
  const object = chosen?.isPlaced ? chosen : null;
  return (
    <section class="result panel" aria-labelledby="result-title" data-source={chosen?.pose.value.source ?? "none"}>
      <h2 id="result-title">
        Result
        {chosen !== null && (scene.value?.objects.length ?? 0) > 1 && (
          <span class="of">
            <span class="swatch" style={{ background: chosen.colour }} /> {chosen.name}
          </span>
        )}
      </h2>
      <Size object={object} />
      {run?.state === "failed" && (
        <p class="error" role="alert">
          {run.error.message}
        </p>
      )}
      <Alternatives object={object} />
      <MetricTable object={object} />
      <Pose object={object} />
      <Warnings object={object} />
      {object !== null && <StageTimes object={object} />}
    </section>
  );
}

const sides = ["width", "height", "depth"];

function Size({ object }: { object: ObjectModel | null }) {
  const sizeM = object?.box.value.sizeM ?? [null, null, null];
  const largestM = Math.max(...sizeM.map((side) => side ?? 0));
  return (
    <div class="size">
      <p class="dimensions">
        <span id="dimensions">
          {sizeM.map((side, i) => (
            <span key={sides[i]}>
              {i > 0 && <span class="times"> × </span>}
              {orDash(side, (m) => centimetres(m, largestM))}
            </span>
          ))}{" "}
          <span class="unit">cm</span>
        </span>
        <Tip label="size">Width × height × depth of the object's bounding box, along x, y and z of the mesh.</Tip>
      </p>
      <Confidence object={object} />
    </div>
  );
}

function Confidence({ object }: { object: ObjectModel | null }) {
  const confidence = object?.precise?.confidence ?? null;
  const reason = reasonForNoConfidence(object);
  if (confidence === null || reason !== null) {
    return (
      <p class="badge" data-level="none">
        {reason ?? "No confidence"}
      </p>
    );
  }
  const level = confidence >= 0.9 ? "high" : confidence >= 0.7 ? "medium" : "low";
  const advice = {
    high: "Likely correct",
    medium: "Check it",
    low: "Unreliable: fix it",
  }[level];
  return (
    <p class="badge" data-level={level}>
      <span id="confidence">
        {percent(confidence)} · {advice}
      </span>
      <Tip label="confidence">
        Probability that the pose is correct: scale within 5 %, rotation within 10°, position within 5 % of the object's
        size. It is calibrated on generated cases and assumes that the mesh is that of the object. Below 70 %, try the
        alternatives, enter prior knowledge (size, up axis), or move the mesh roughly into place and refine.
      </Tip>
    </p>
  );
}

/** The confidence is that of the result's pose only. */
function reasonForNoConfidence(object: ObjectModel | null): string | null {
  const source = object?.pose.value.source;
  if (source === undefined) return "No result yet";
  return source === "hand" ? "Moved by hand" : source === "alternative" ? "Alternative" : null;
}

function Alternatives({ object }: { object: ObjectModel | null }) {
  const alignment = object?.alignment.value ?? null;
  const best = object?.precise ?? null;
  const alternatives = best?.alternatives ?? [];
  const shown = object === null ? null : shownAlternative(object);
  const apply = (index: number) => object !== null && applyAlternative(object, index);
  return (
    <fieldset class="alternatives" disabled={alignment === null}>
      <legend class="visually-hidden">Result and alternatives</legend>
      <button type="button" aria-pressed={shown === -1} onClick={() => apply(-1)}>
        Best
      </button>
      {alternatives.slice(0, 8).map(({ turnDeg, score }, i) => (
        <button
          key={`${turnDeg} ${score}`}
          type="button"
          aria-pressed={shown === i}
          title={`Rotated by ${turnDeg.toFixed(0)}°, score ${score.toFixed(3)} (best: ${best?.diagnostics.score.toFixed(3)})`}
          onClick={() => apply(i)}
        >
          {turnDeg.toFixed(0)}°
        </button>
      ))}
      <span class="quiet">
        {alternatives.length === 0 ? "No alternatives." : "Alternatives, by rotation."}
        <Tip label="alternatives">
          Other poses that explain the observation nearly as well, best first. Objects that look similar from several
          sides have several. Each button shows one of them; the angle is its rotation from the result.
        </Tip>
      </span>
    </fieldset>
  );
}

function MetricTable({ object }: { object: ObjectModel | null }) {
  const metrics = object?.metrics.value ?? null;
  return (
    <dl class="metrics" id="metrics">
      {metricTexts.map(({ name, title, about, better, show }) => (
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
  const source = object?.pose.value.source;
  const isResult = source === "aligned" || source === "refined";
  const uncertainty = isResult ? object?.precise?.uncertainty : null;
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
  const isKnown = object === null ? inputs.value.objects.some(({ truth }) => truth !== null) : object.truth !== null;
  return (
    <dl class="facts">
      {rows.map(([title = "", text]) => (
        <div key={title}>
          <dt>{title}</dt>
          <dd id={title.toLowerCase()}>{text}</dd>
        </div>
      ))}
      {isKnown && (
        <div id="errors">
          <dt>
            Errors
            <Tip label="errors">Errors of the pose compared with the true pose.</Tip>
          </dt>
          <dd>{orDash(object?.errors.value, errorText)}</dd>
        </div>
      )}
    </dl>
  );
}

const errorText = ({ scaleError, rotationErrorDeg, translationErrorM }: PoseErrors) =>
  [
    `scale ${significant(100 * scaleError, 2)} %`,
    `rotation ${significant(rotationErrorDeg, 2)}°`,
    `translation ${significant(1000 * translationErrorM, 2)} mm`,
  ].join(", ");

function Warnings({ object }: { object: ObjectModel | null }) {
  const warnings = [
    ...(scene.value?.warnings ?? []),
    ...(object?.alignment.value?.warnings.map(({ message }) => message) ?? []),
  ];
  if (warnings.length === 0) return null;
  return (
    <ul class="warnings">
      {warnings.map((warning) => (
        <li key={warning}>{warning}</li>
      ))}
    </ul>
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
