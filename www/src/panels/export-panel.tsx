/** Buttons that copy or save results. */
import { allExports, listExport, videoExport } from "../export/export.js";
import { page } from "../state/page.js";

const { list, scene, selected, video } = page;

export function ExportPanel() {
  const [whole, object] = [scene.value, selected.value];
  return (
    <details class="panel export-panel" open>
      <summary>
        <h2>Export</h2>
      </summary>
      <fieldset class="exports" disabled={whole === null || !object?.isPlaced}>
        <legend class="visually-hidden">Poses, files and images</legend>
        {[
          ...(video.value === null ? [] : [videoExport]),
          ...allExports,
          ...(list.value.length > 1 ? [listExport] : []),
        ].map(([title, act]) => (
          <button key={title} type="button" onClick={() => whole !== null && object !== null && act(whole, object)}>
            {title}
          </button>
        ))}
      </fieldset>
      {whole !== null && whole.sample === null && <p class="quiet">Your own files cannot be linked.</p>}
    </details>
  );
}
