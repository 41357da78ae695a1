/** What came of it: size, pose, how sure it is, metrics, other poses. */
import { applyAlternative, shownAlternative } from "../run/alternatives.js";
import type { ObjectModel } from "../state/object-model.js";
import { scene, selected } from "../state/scene.js";
import { centimetres, orDash, percent, significant } from "../ui/format.js";
import { metricTexts } from "../ui/metric-texts.js";
import { Tip } from "../ui/tip.js";
import { StageTimes } from "./stage-times.js";

export function ResultPanel() {
  const object = selected.value;
  return (
    <section class="result panel" aria-labelledby="result-title" data-source={object?.pose.value.source ?? "none"}>
      <h2 id="result-title">
        Result
        {object !== null && (scene.value?.objects.length ?? 0) > 1 && (
          <span class="of">
            <span class="swatch" style={{ background: object.colour }} /> {object.name}
          </span>
        )}
      </h2>
      {object?.isPlaced ? <Result object={object} /> : <Nothing object={object} />}
    </section>
  );
}

function Nothing({ object }: { object: ObjectModel | null }) {
  const run = object?.run.value;
  if (run?.state === "failed") {
    return (
      <p class="error" role="alert">
        {run.error.message}
      </p>
    );
  }
  return <p class="quiet">{run?.state === "cancelled" ? "Cancelled before there was a result." : "No result yet."}</p>;
}

function Result({ object }: { object: ObjectModel }) {
  const run = object.run.value;
  return (
    <>
      <Size object={object} />
      {run.state === "failed" && (
        <p class="error" role="alert">
          {run.error.message}
        </p>
      )}
      <Alternatives object={object} />
      <MetricTable object={object} />
      <Pose object={object} />
      <Warnings object={object} />
      <StageTimes object={object} />
    </>
  );
}

const sides = ["width", "height", "depth"];

function Size({ object }: { object: ObjectModel }) {
  const { sizeM } = object.box.value;
  return (
    <div class="size">
      <p class="dimensions" id="dimensions">
        {sizeM.map((side, i) => (
          <span key={sides[i]}>
            {i > 0 && <span class="times"> × </span>}
            <span title={`${sides[i]}, along the mesh's ${"xyz"[i]} axis`}>
              {centimetres(side, Math.max(...sizeM))}
            </span>
          </span>
        ))}{" "}
        <span class="unit">cm</span>
      </p>
      <Confidence object={object} />
    </div>
  );
}

function Confidence({ object }: { object: ObjectModel }) {
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
    <p class="badge" id="confidence" data-level={level}>
      {percent(confidence)} · {advice}
      <Tip label="the confidence">
        How likely the pose is right: scale within 5 %, rotation within 10°, position within 5 % of the object's size.
        It was calibrated on generated cases. From 90 % on, take it; below 70 %, try the alternatives, or say what is
        known: a size, what is up, a rough pose.
      </Tip>
    </p>
  );
}

function Alternatives({ object }: { object: ObjectModel }) {
  const alignment = object.alignment.value;
  const count = alignment?.alternatives.length ?? 0;
  if (alignment === null) return null;
  const shown = shownAlternative(object);
  return (
    <fieldset class="alternatives">
      <legend class="visually-hidden">Poses that explain the picture</legend>
      <button type="button" aria-pressed={shown === -1} onClick={() => applyAlternative(object, -1)}>
        Best
      </button>
      {alignment.alternatives.slice(0, 8).map(({ turnDeg, score }, i) => (
        <button
          key={`${turnDeg} ${score}`}
          type="button"
          aria-pressed={shown === i}
          title={`Turned by ${turnDeg.toFixed(0)}°, score ${score.toFixed(3)} (best: ${alignment.score?.toFixed(3)})`}
          onClick={() => applyAlternative(object, i)}
        >
          {turnDeg.toFixed(0)}°
        </button>
      ))}
      <span class="quiet">
        {count === 0 ? "No other pose comes near." : "Other poses, by their turn."}
        <Tip label="an alternative">
          Poses that explain the picture nearly as well, best first: an object that looks alike from several sides has
          several. Each button turns the mesh to one of them.
        </Tip>
      </span>
    </fieldset>
  );
}

function MetricTable({ object }: { object: ObjectModel }) {
  const metrics = object.metrics.value;
  return (
    <dl class="metrics" id="metrics">
      {metricTexts.map(({ name, title, about, better, show }) => (
        <div key={name}>
          <dt>
            {title}
            <Tip label={title.toLowerCase()}>
              {about} {better === "high" ? "More is better." : "Less is better."}
            </Tip>
          </dt>
          <dd data-metric={name} data-value={metrics?.[name] ?? ""}>
            {metrics === null ? "…" : orDash(metrics[name], show)}
          </dd>
        </div>
      ))}
    </dl>
  );
}

function Pose({ object }: { object: ObjectModel }) {
  const { transform, source } = object.pose.value;
  const { centerM } = object.box.value;
  const found = object.alignment.value;
  const uncertainty = source === "aligned" || source === "refined" ? (found?.uncertainty ?? null) : null;
  const errors = object.errors.value;
  return (
    <dl class="facts">
      <div>
        <dt>Scale</dt>
        <dd>
          {significant(transform.scale, 5)} m per mesh unit
          {uncertainty !== null && ` ± ${significant(100 * uncertainty.scale, 2)} %`}
        </dd>
      </div>
      <div>
        <dt>Middle</dt>
        <dd>
          {centerM.map((x) => x.toFixed(3)).join(", ")} m
          {uncertainty !== null && ` ± ${significant(1000 * uncertainty.distanceM, 2)} mm`}
        </dd>
      </div>
      <div>
        <dt>Rotation</dt>
        <dd>
          {transform.rotation.map((x) => x.toFixed(3)).join(", ")}
          {uncertainty !== null && ` ± ${significant(uncertainty.rotationDeg, 2)}°`}
        </dd>
      </div>
      {object.truth !== null && (
        <div id="errors">
          <dt>Truth</dt>
          <dd>
            {errors === null
              ? "…"
              : `scale ${significant(100 * errors.scaleError, 2)} %, turned ${significant(errors.rotationErrorDeg, 2)}°, moved ${significant(1000 * errors.translationErrorM, 2)} mm`}
          </dd>
        </div>
      )}
    </dl>
  );
}

function Warnings({ object }: { object: ObjectModel }) {
  const warnings = [
    ...(scene.value?.warnings ?? []),
    ...(object.alignment.value?.warnings.map(({ message }) => message) ?? []),
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
