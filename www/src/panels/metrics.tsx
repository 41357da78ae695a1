/** Metrics of the pose. */
import type { ObjectModel } from "../state/object-model.js";
import { Tip } from "../ui/controls.js";
import { orDash } from "../ui/format.js";
import { type MetricText, metricTexts } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

/** The metrics that are always shown. */
export const MAIN = 3;

export const MainMetrics = ({ object }: { object: ObjectModel | null }) => (
  <MetricTable object={object} metrics={metricTexts.slice(0, MAIN)} id="metrics" />
);

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
      {texts.map(({ name, title, about, better, show }) => (
        <div key={name}>
          <dt>
            {title}
            <Tip label={title}>
              {about} {better === "higher" ? "Higher is better." : "Lower is better."}
            </Tip>
          </dt>
          <dd data-metric={name} data-value={metrics?.[name] ?? ""}>
            {metrics === null ? (object === null ? "–" : "…") : orDash(metrics[name], (value) => show(value, unit))}
          </dd>
        </div>
      ))}
    </dl>
  );
}
