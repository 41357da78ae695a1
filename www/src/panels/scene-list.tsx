/** The user's own scenes and videos, each with how far the work on it is. */
import { useEffect, useRef } from "preact/hooks";
import { isOfKind, openListed, orderedList, progressOf } from "../opening/open.js";
import type { Listed, SceneKind } from "../state/opened.js";
import { page } from "../state/page.js";
import { Check, Choices } from "../ui/controls.js";
import { percent } from "../ui/texts.js";

const { inputs, list, listed } = page;

/** What is to be done, and how sure the least sure pose is. */
function textOf(one: Listed): string {
  const { accepted, confidence, decided, objects, state } = progressOf(one) ?? { state: "to do" };
  if (state === "decided") return accepted === objects ? "✓ accepted" : "✓ decided";
  const count = decided ? `${decided} of ${objects} · ` : "";
  if (state === "aligned" && confidence != null) return `${count}${percent(confidence)}`;
  return `${count}${state === "unsure" ? `look at it, ${percent(confidence ?? 0)}` : state}`;
}

const kinds: readonly (readonly [SceneKind, string])[] = [
  ["any", "All"],
  ["doubtful", "Need you"],
  ["open", "Open"],
];

export function ScenesPanel() {
  const all = list.value;
  const { kind, isSorted } = listed.value;
  const rows = useRef<HTMLUListElement>(null);
  const { id } = inputs.value;
  useEffect(() => rows.current?.querySelector('[aria-pressed="true"]')?.scrollIntoView({ block: "nearest" }), [id]);
  if (all.length === 0) return null;
  const isShown = (one: Listed) => one.inputs.id === id;
  const count = (of: SceneKind) => all.filter((one) => isOfKind(one, of)).length;
  return (
    <section class="panel scenes-panel" style={{ gridArea: "scenes" }} aria-labelledby="scenes-title">
      <div class="row panel-head">
        <h2 id="scenes-title">Scenes</h2>
        <span class="quiet">
          {all.length - count("open")} of {all.length} decided
        </span>
      </div>
      {all.length > 1 && (
        <div class="row">
          <Choices
            id="scene-kind"
            label="Which scenes"
            value={kind}
            choices={kinds.map(([of, title]) => [of, `${title} (${count(of)})`] as const)}
            onChoose={(chosen) => {
              listed.value = { ...listed.peek(), kind: chosen };
            }}
          />
          <Check
            id="scenes-sorted"
            title="Least sure first"
            checked={isSorted}
            onCheck={(checked) => {
              listed.value = { ...listed.peek(), isSorted: checked };
            }}
          />
        </div>
      )}
      <ul class="stack scenes" ref={rows} aria-labelledby="scenes-title">
        {orderedList()
          .filter((one) => isShown(one) || isOfKind(one, kind))
          .map((one) => (
            <li key={one.inputs.id} data-state={progressOf(one)?.state ?? "to do"}>
              <button
                type="button"
                aria-pressed={isShown(one)}
                title={one.inputs.name}
                onClick={() => openListed(one.inputs)}
              >
                <span class="listed">{one.inputs.name}</span> <span class="quiet how">{textOf(one)}</span>
              </button>
            </li>
          ))}
      </ul>
    </section>
  );
}
