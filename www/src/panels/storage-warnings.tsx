/** Storage warnings: scenes that could not be stored, or are open in another tab. */
import { saveProject } from "../export/export.js";
import { page } from "../state/page.js";

const { notKept, othersScenes } = page;

const others = () => import("../session/others.js");

/** Names that are listed before the rest is counted. */
const MOST = 3;

export function StorageWarnings() {
  const [reason, foreign] = [notKept.value, othersScenes.value];
  const names = foreign.slice(0, MOST).map(({ name }) => name);
  const more = foreign.length - names.length;
  return (
    <>
      {reason !== null && (
        <section class="panel kept" id="not-kept" aria-label="Not kept">
          <p class="error" role="alert">
            {reason}
          </p>
          <button type="button" onClick={saveProject}>
            Save the project
          </button>
        </section>
      )}
      {foreign.length > 0 && (
        <section class="panel kept" id="other-tabs" aria-label="Scenes of other tabs">
          <p role="status">
            Another tab has {names.join(", ")}
            {more > 0 && ` and ${more} more`} open.
          </p>
          <div class="row">
            <button type="button" id="copy-others" onClick={async () => (await others()).copyOthers()}>
              Open a copy
            </button>
            <button
              type="button"
              id="take-over"
              title="The other tab closes what it has open; nothing of it is lost"
              onClick={async () => (await others()).takeOverOthers()}
            >
              Take over
            </button>
          </div>
        </section>
      )}
    </>
  );
}
