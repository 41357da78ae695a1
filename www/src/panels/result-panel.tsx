/**
 * The result: size, confidence, and the decision about it. Everything takes its space before there is a result, so that the
 * layout does not shift.
 */
import type { PoseErrors } from "sim3align";
import { fieldOf } from "../input/problems.js";
import type { ObjectModel } from "../state/object-model.js";
import { SURE } from "../state/progress.js";
import { inOrder, sidesOf } from "../state/sides.js";
import type { MetricText } from "../ui/texts.js";
import { orDash, overlapText, percent, significant, size } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";
import { Advised, Alternatives, Details, Remedies, Warnings } from "./lazy-panels.js";

export function ResultPanel() {
  const { isReadonly, selected } = useWorkspace();
  const chosen = selected.value;
  const run = chosen?.run.value;
  const object = chosen?.isPlaced ? chosen : null;
  return (
    <section
      class="result panel"
      style={{ gridArea: "result" }}
      part="result"
      aria-labelledby="result-title"
      data-source={chosen?.pose.value.source ?? "none"}
    >
      <h2 class="row" id="result-title">
        {chosen === null ? (
          "Result"
        ) : (
          <>
            <span class="swatch" style={{ background: chosen.colour }} />
            {chosen.name}
          </>
        )}
      </h2>
      <Size object={object} />
      <Advised object={object} />
      {run?.state === "failed" && <Failure error={run.error} />}
      {!isReadonly.value && (
        <>
          <Remedies object={object} />
          <Alternatives object={object} />
        </>
      )}
      <MetricTable object={object} metrics={[overlapText]} id="metrics" />
      <Truth object={object} />
      <Warnings object={object} />
      <Details object={object} />
    </section>
  );
}

function Failure({ error }: { error: Error }) {
  const files = useWorkspace().fileActions.value;
  return (
    <p class="error" role="alert">
      {files?.words(error) ?? error.message}{" "}
      {files !== null && fieldOf(error) !== null && (
        <button type="button" onClick={files.edit}>
          Change files …
        </button>
      )}
    </p>
  );
}

function Size({ object }: { object: ObjectModel | null }) {
  const { support, unit: shownUnit } = useWorkspace();
  const unit = shownUnit.value;
  const sides = object && sidesOf(object, support.value);
  const sizeM = sides === null || object === null ? [null, null, null] : inOrder(sides, object.box.value.sizeM);
  const largestM = Math.max(...sizeM.map((side) => side ?? 0));
  return (
    <div class="size">
      <p
        class="dimensions"
        title={
          unit === null
            ? "Along the sides of the smallest box"
            : "The depth map has no unit: multiples of the longest side of the first object"
        }
      >
        <span id="dimensions">
          {sizeM.map((side, i) => (
            <span key={i}>
              {i > 0 && <span class="times"> × </span>}
              {orDash(side, (m) => size(m, unit, largestM).split(" ")[0] ?? "")}
            </span>
          ))}{" "}
          <span class="unit">{unit === null ? "cm" : "relative"}</span>
        </span>
      </p>
      <p class="quiet sides">{sides?.isUpright ? "width × depth × height" : "longest side first"}</p>
      <Confidence object={object} />
    </div>
  );
}

function Confidence({ object }: { object: ObjectModel | null }) {
  const { frameIndex, framePoses } = useWorkspace();
  const isTracked = object?.pose.value.source === "tracked";
  const frame = framePoses.value[frameIndex.value] ?? null;
  const confidence = isTracked ? (frame?.confidence ?? null) : (object?.confidence ?? null);
  const reason = isTracked && frame?.isCorrected ? "Set by hand" : reasonForNoConfidence(object);
  if (confidence === null || reason !== null) {
    return (
      <p class="badge" data-level="none">
        {reason ?? "No confidence"}
      </p>
    );
  }
  const doubt = object?.doubt ?? null;
  // A doubt of the size or the turn has lowered the confidence, and is named as what it is.
  const without = doubt === null ? confidence : (object?.precise?.shapeConfidence ?? confidence);
  const level = without < 0.7 ? "low" : confidence < SURE || doubt !== null ? "medium" : "high";
  const medium = doubt === null ? "Check it" : `Check the ${doubt}`;
  const advice = { high: "Likely correct", medium, low: "Unreliable: fix it" }[level];
  return (
    <p class="badge" data-level={level}>
      <span id="confidence">
        {percent(confidence)} · {advice}
      </span>
    </p>
  );
}

/** The confidence is that of the result's pose only. */
function reasonForNoConfidence(object: ObjectModel | null): string | null {
  const source = object?.pose.value.source;
  if (source === undefined) return "No result yet";
  return source === "hand" ? "Moved by hand" : source === "alternative" ? "Alternative" : null;
}

/** Errors of the pose compared with the true one, if that is known. */
function Truth({ object }: { object: ObjectModel | null }) {
  const { inputs, unit } = useWorkspace();
  if (unit.value !== null) return null;
  const isKnown = object === null ? inputs.value.objects.some(({ truth }) => truth !== null) : object.truth !== null;
  if (!isKnown) return null;
  return (
    <p id="errors" class="quiet">
      Error vs ground truth: {orDash(object?.errors.value, errorText)}
    </p>
  );
}

const errorText = ({ scaleError, rotationErrorDeg, translationErrorM }: PoseErrors) =>
  [
    `scale ${significant(100 * scaleError, 2)} %`,
    `${significant(rotationErrorDeg, 2)}°`,
    `${significant(1000 * translationErrorM, 2)} mm`,
  ].join(", ");

interface MetricTableProps {
  object: ObjectModel | null;
  metrics: readonly MetricText[];
  id: string;
}

export function MetricTable({ object, metrics: texts, id }: MetricTableProps) {
  const metrics = object?.metrics.value ?? null;
  const unit = useWorkspace().unit.value;
  return (
    <dl class="metrics" id={id}>
      {texts.map(({ name, title, show }) => (
        <div key={name}>
          <dt>{title}</dt>
          <dd data-metric={name} data-value={metrics?.[name] ?? ""}>
            {metrics === null ? (object === null ? "–" : "…") : orDash(metrics[name], (value) => show(value, unit))}
          </dd>
        </div>
      ))}
    </dl>
  );
}
