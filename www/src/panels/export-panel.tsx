/** Buttons that copy or save results. */
import { allExports, listExport, videoExport } from "../export/export.js";
import { page } from "../state/page.js";
import { Menu } from "../ui/controls.js";

const { list, scene, selected, video } = page;

/** What is not behind "More formats". */
const first = new Set<unknown>([videoExport, listExport, ...allExports.filter(([title]) => title === "JSON")]);

export function ExportPanel() {
  const [whole, object] = [scene.value, selected.value];
  const isReady = whole !== null && object?.isPlaced === true;
  const all = [
    ...(video.value === null ? [] : [videoExport]),
    ...allExports,
    ...(list.value.length > 1 ? [listExport] : []),
  ];
  const buttons = (isFirst: boolean) => (
    <fieldset class="exports" disabled={!isReady}>
      <legend class="visually-hidden">Poses, files and images</legend>
      {all
        .filter((one) => first.has(one) === isFirst)
        .map(([title, act]) => (
          <button key={title} type="button" onClick={() => whole !== null && object !== null && act(whole, object)}>
            {title}
          </button>
        ))}
    </fieldset>
  );
  return (
    <section class="panel export-panel" aria-labelledby="export-title">
      <h2 id="export-title">Export</h2>
      <div class="row">
        {buttons(true)}
        <Menu title="More formats" label="More formats">
          {buttons(false)}
          {whole !== null && whole.sample === null && <p class="quiet">Your own files cannot be linked.</p>}
        </Menu>
      </div>
    </section>
  );
}
