/**
 * What came of it: size, pose, how sure it is, metrics, other poses. Everything has its place before there is anything to
 * be shown, so that nothing jumps.
 */
import type { PoseErrors } from "sim3align";
import { inputs } from "../load/open.js";
import { applyAlternative, shownAlternative } from "../run/alternatives.js";
import type { ObjectModel } from "../state/object-model.js";
import { scene, selected } from "../state/scene.js";
import { centimetres, orDash, percent, significant } from "../ui/format.js";
import { metricTexts } from "../ui/metric-texts.js";
import { Tip } from "../ui/tip.js";
import { StageTimes } from "./stage-times.js";

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
        <Tip label="the size">
          Width × height × depth of the box around the object, along the mesh's own x, y and z.
        </Tip>
      </p>
      <Confidence object={object} />
    </div>
  );
}

function Confidence({ object }: { object: ObjectModel | null }) {
  if (object === null) {
    return (
      <p class="badge" data-level="none">
        No result yet
      </p>
    );
  }
  const { source } = object.pose.value;
  const confidence = object.alignment.value?.confidence ?? null;
  if (source === "hand")
    return (
      <p class="badge" data-level="none">
        Moved by hand
      </p>
    );
  if (source === "alternative")
    return (
      <p class="badge" data-level="none">
        An alternative
      </p>
    );
  if (confidence === null)
    return (
      <p class="badge" data-level="none">
        No confidence
      </p>
    );
  const level = confidence >= 0.9 ? "high" : confidence >= 0.7 ? "middle" : "low";
  const advice = {
    high: "Likely right",
    middle: "Have a look",
    low: "Unsure",
  }[level];
  return (
    <p class="badge" data-level={level}>
      <span id="confidence">
        {percent(confidence)} · {advice}
      </span>
      <Tip label="the confidence">
        How likely the pose is right: scale within 5 %, rotation within 10°, position within 5 % of the object's size.
        It was calibrated on generated cases. From 90 % on, take it; below 70 %, try the alternatives, or say what is
        known: a size, what is up, a rough pose.
      </Tip>
    </p>
  );
}

function Alternatives({ object }: { object: ObjectModel | null }) {
  const alignment = object?.alignment.value ?? null;
  const alternatives = alignment?.alternatives ?? [];
  const shown = object === null ? null : shownAlternative(object);
  const put = (index: number) => object !== null && applyAlternative(object, index);
  return (
    <fieldset class="alternatives" disabled={alignment === null}>
      <legend class="visually-hidden">Poses that explain the picture</legend>
      <button type="button" aria-pressed={shown === -1} onClick={() => put(-1)}>
        Best
      </button>
      {alternatives.slice(0, 8).map(({ turnDeg, score }, i) => (
        <button
          key={`${turnDeg} ${score}`}
          type="button"
          aria-pressed={shown === i}
          title={`Turned by ${turnDeg.toFixed(0)}°, score ${score.toFixed(3)} (best: ${alignment?.score?.toFixed(3)})`}
          onClick={() => put(i)}
        >
          {turnDeg.toFixed(0)}°
        </button>
      ))}
      <span class="quiet">
        {alternatives.length === 0 ? "No other pose comes near." : "Other poses, by their turn."}
        <Tip label="an alternative">
          Poses that explain the picture nearly as well, best first: an object that looks alike from several sides has
          several. Each button turns the mesh to one of them.
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
              {about} {better === "high" ? "More is better." : "Less is better."}
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
  const uncertainty = isResult ? object?.alignment.value?.uncertainty : null;
  // What the view leaves open, to one standard deviation.
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
      "Middle",
      `${list(object?.box.value.centerM)} m${within(uncertainty ? 1000 * uncertainty.distanceM : undefined, " mm")}`,
    ],
    ["Rotation", `${list(transform?.rotation)}${within(uncertainty?.rotationDeg, "°")}`],
  ];
  const isKnown = object === null ? inputs.value.truths.length > 0 : object.truth !== null;
  return (
    <dl class="facts">
      {rows.map(([title, text]) => (
        <div key={title}>
          <dt>{title}</dt>
          <dd>{text}</dd>
        </div>
      ))}
      {isKnown && (
        <div id="errors">
          <dt>
            Truth
            <Tip label="the truth">How far the pose is from the one that is known to be right.</Tip>
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
    `turned ${significant(rotationErrorDeg, 2)}°`,
    `moved ${significant(1000 * translationErrorM, 2)} mm`,
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
