/** The user's own scenes, if there are several, each with how far the work on it is. */
import { isOpen, nextListed, openListed, openNext, progressOf } from "../load/open.js";
import type { Listed } from "../state/opened.js";
import { page } from "../state/page.js";

const { inputs, list } = page;

function textOf(one: Listed): string {
  const { accepted, objects, state } = progressOf(one) ?? { accepted: 0, objects: 0, state: "to do" };
  if (state === "accepted") return "✓ accepted";
  return accepted === 0 ? state : `${state}, ${accepted} of ${objects} accepted`;
}

export function ScenesPanel() {
  const all = list.value;
  if (all.length < 2) return null;
  return (
    <section class="panel scenes-panel" aria-labelledby="scenes-title">
      <h2 id="scenes-title">Scenes</h2>
      <ul class="scenes" aria-labelledby="scenes-title">
        {all.map((one) => (
          <li key={one.inputs.id} data-state={progressOf(one)?.state ?? "to do"}>
            <button
              type="button"
              aria-pressed={one.inputs.id === inputs.value.id}
              onClick={() => openListed(one.inputs)}
            >
              <span class="listed">{one.inputs.name}</span> <span class="quiet">{textOf(one)}</span>
            </button>
          </li>
        ))}
      </ul>
      <button type="button" id="next-scene" disabled={nextListed() === null} onClick={openNext}>
        Next scene ({all.filter(isOpen).length} left)
      </button>
    </section>
  );
}
