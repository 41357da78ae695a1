/** Metrics of the pose. */
import type { ObjectModel } from "../state/object-model.js";
import { orDash } from "../ui/format.js";
import type { MetricText } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

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
