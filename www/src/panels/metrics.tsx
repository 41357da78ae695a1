/** Metrics of the pose. */
import type { ObjectModel } from "../state/object-model.js";
import { Tip } from "../ui/controls.js";
import { orDash } from "../ui/format.js";
import { type MetricText, metricTexts } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

/** The metrics that are always shown. */
export const MAIN = 3;

const main = metricTexts.slice(0, MAIN);

/** The main metrics, with one explanation of all of them. */
export const MainMetrics = ({ object }: { object: ObjectModel | null }) => (
  <MetricTable object={object} metrics={main} id="metrics" isBrief />
);

const explained = ({ about, better }: MetricText) =>
  `${about} ${better === "higher" ? "Higher is better." : "Lower is better."}`;

interface MetricTableProps {
  object: ObjectModel | null;
  metrics: readonly MetricText[];
  id: string;
  /** Whether the first metric explains all. */
  isBrief?: boolean;
}

export function MetricTable({ object, metrics: texts, id, isBrief = false }: MetricTableProps) {
  const metrics = object?.metrics.value ?? null;
  const unit = useWorkspace().unit.value;
  return (
    <dl class="metrics" id={id}>
      {texts.map((text, i) => {
        const { name, title, show } = text;
        return (
          <div key={name}>
            <dt>
              {title}
              {!isBrief && <Tip label={title}>{explained(text)}</Tip>}
              {isBrief && i === 0 && (
                <Tip label="these metrics">
                  {texts.map((one) => (
                    <p key={one.name}>
                      <b>{one.title}</b>: {explained(one)}
                    </p>
                  ))}
                </Tip>
              )}
            </dt>
            <dd data-metric={name} data-value={metrics?.[name] ?? ""}>
              {metrics === null ? (object === null ? "–" : "…") : orDash(metrics[name], (value) => show(value, unit))}
            </dd>
          </div>
        );
      })}
    </dl>
  );
}
