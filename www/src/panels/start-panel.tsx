/** Where to begin: the user's own files, or a sample. */

import { alignAll } from "../alignment/align.js";
import { offlineState } from "../offline/offline.js";
import { openFiles, openSample } from "../opening/open.js";
import { type Sample, samples, sampleUrl } from "../opening/samples.js";
import { page } from "../state/page.js";
import { FileButton, Menu } from "../ui/controls.js";

const { inputs, isSettled, scene } = page;

const offlineTexts = { unknown: "", stored: " Works offline.", newer: " Reload for a new version." };

async function choose(sample: Sample): Promise<void> {
  if (await openSample(sample)) await alignAll(page);
}

/** Whether the page shows the user's own files. */
const isOwn = () => scene.value !== null && scene.value.sample === null;

export const StartPanel = () => (
  <section class="stack panel start" style={{ gridArea: "start" }} aria-label="Open" data-own={isOwn()}>
    <div class="row">
      <FileButton id="files" look={isOwn() ? "" : "primary"} multiple onFiles={openFiles}>
        {isOwn() ? "Open files" : "Drop or choose files"}
      </FileButton>
      <FileButton id="folder" webkitdirectory onFiles={openFiles}>
        Folder
      </FileButton>
      {isOwn() && (
        <Menu title="Samples" label="Samples">
          <Gallery />
        </Menu>
      )}
    </div>
    {(!isOwn() || offlineState.value === "newer") && (
      <p class="quiet" id="privacy">
        Nothing leaves this device.{offlineTexts[offlineState.value]}
      </p>
    )}
  </section>
);

/** The samples beside the first of them; beside own files, they are in a menu. */
export function SamplesPanel() {
  if (isOwn()) return null;
  return (
    <section class="panel samples-panel" style={{ gridArea: "samples" }} aria-labelledby="samples-title">
      <h2 id="samples-title">Samples</h2>
      <Gallery />
    </section>
  );
}

function Gallery() {
  const shown = scene.value?.sample ?? inputs.value.sample;
  return (
    <ul class="samples">
      {/* Pictures come after the first result. */}
      {samples.map((sample) => (
        <li key={sample.id}>
          <button
            type="button"
            data-sample={sample.id}
            aria-pressed={shown === sample.id}
            title={sample.about}
            onClick={() => choose(sample)}
          >
            <img src={isSettled.value ? sampleUrl(sample.picture) : undefined} alt="" width="160" height="120" />
            <span>{sample.title}</span>
          </button>
        </li>
      ))}
    </ul>
  );
}
