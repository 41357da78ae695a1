/** Where to begin: the user's own files, or a sample. */

import { alignAll } from "../alignment/align.js";
import { offlineState } from "../offline/offline.js";
import { openFiles, openSample } from "../opening/open.js";
import { sampleOf, samples, sampleUrl } from "../opening/samples.js";
import { page } from "../state/page.js";
import { FileButton, Menu } from "../ui/controls.js";

const { scene } = page;

const offlineTexts = { unknown: "", stored: " Works offline.", newer: " Reload for a new version." };

async function choose(id: string): Promise<void> {
  const sample = sampleOf(id);
  if (sample !== undefined && (await openSample(sample))) await alignAll(page);
}

/** The samples that are shown as pictures. */
const pictured = samples.filter(({ picture }) => picture !== undefined);

export function StartPanel() {
  const shown = scene.value?.sample ?? "";
  return (
    <section class="panel start" aria-label="Open" data-own={scene.value !== null && shown === ""}>
      <FileButton id="files" look="primary drop" multiple onFiles={openFiles}>
        <span>Drop or choose files</span>
        <small>Depth map, masks, meshes and camera</small>
      </FileButton>
      <p class="quiet" id="privacy">
        Nothing leaves this device.{offlineTexts[offlineState.value]}
      </p>
      <Menu title="Samples" label="Samples and folders">
        <ul class="samples">
          {pictured.map(({ id, title, about, picture = "" }) => (
            <li key={id}>
              <button
                type="button"
                data-sample={id}
                aria-pressed={shown === id}
                title={about}
                onClick={() => choose(id)}
              >
                <img src={sampleUrl(picture)} alt="" width="160" height="120" loading="lazy" />
                <span>{title}</span>
              </button>
            </li>
          ))}
        </ul>
        <div class="row">
          <label class="field-inline">
            <span>All samples</span>
            <select
              id="sample"
              value={shown}
              onChange={async ({ currentTarget }) => {
                await choose(currentTarget.value);
                // If it could not be loaded, the scene that is shown is still the one before.
                currentTarget.value = scene.peek()?.sample ?? "";
              }}
            >
              {shown === "" && <option value="">Own files</option>}
              {samples.map(({ id, title }) => (
                <option key={id} value={id}>
                  {title}
                </option>
              ))}
            </select>
          </label>
          <FileButton id="folder" webkitdirectory onFiles={openFiles}>
            <span>Open a folder</span>
          </FileButton>
        </div>
      </Menu>
    </section>
  );
}
