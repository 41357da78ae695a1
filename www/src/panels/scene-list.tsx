/** The user's own scenes and videos, each with how far the work on it is. */
import { signal } from "@preact/signals";
import { isOfKind, openListed, progressOf } from "../opening/open.js";
import type { Listed } from "../state/opened.js";
import { page } from "../state/page.js";
import { Check } from "../ui/controls.js";
import { percent } from "../ui/texts.js";

const { inputs, list } = page;

const onlyDoubtful = signal(false);

function textOf(one: Listed): string {
  const { accepted, confidence, decided, objects, state } = progressOf(one) ?? { state: "to do" };
  if (state === "decided") return accepted === objects ? "✓ accepted" : "✓ decided";
  const sure = confidence == null ? state : `${state} ${percent(confidence)}`;
  return decided ? `${sure}, ${decided} of ${objects} decided` : sure;
}

export function ScenesPanel() {
  const all = list.value;
  if (all.length === 0) return null;
  const isShown = (one: Listed) => one.inputs.id === inputs.value.id;
  const doubtful = all.filter((one) => isOfKind(one, "doubtful"));
  const listed = onlyDoubtful.value ? all.filter((one) => isShown(one) || doubtful.includes(one)) : all;
  return (
    <section class="panel scenes-panel" aria-labelledby="scenes-title">
      <div class="panel-head">
        <h2 id="scenes-title">Scenes</h2>
        <span class="quiet">{all.filter((one) => isOfKind(one, "open")).length} left</span>
        {(doubtful.length > 0 || onlyDoubtful.value) && (
          <Check
            id="only-doubtful"
            title={`Only what needs you (${doubtful.length})`}
            checked={onlyDoubtful.value}
            onCheck={(checked) => {
              onlyDoubtful.value = checked;
            }}
          />
        )}
      </div>
      <ul class="scenes" aria-labelledby="scenes-title">
        {listed.map((one) => (
          <li key={one.inputs.id} data-state={progressOf(one)?.state ?? "to do"}>
            <button type="button" aria-pressed={isShown(one)} onClick={() => openListed(one.inputs)}>
              <span class="listed">{one.inputs.name}</span> <span class="quiet">{textOf(one)}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
