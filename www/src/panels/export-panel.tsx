/** Buttons that copy or save results. */
import { exportAs, type Format } from "../export/export.js";
import { page } from "../state/page.js";

const { scene, selected, video } = page;

const formats: readonly [format: Format, title: string][] = [
  ["glb", "GLB"],
  ["scene", "GLB of the scene"],
  ["json", "JSON"],
  ["bop", "BOP JSON"],
  ["columns", "Copy matrix (column-major)"],
  ["rows", "Copy matrix (row-major)"],
  ["ply", "PLY"],
  ["session", "Session"],
  ["png", "PNG of the view"],
  ["link", "Copy link"],
];

export function ExportPanel() {
  const [whole, object] = [scene.value, selected.value];
  return (
    <details class="panel export-panel" open>
      <summary>
        <h2>Export</h2>
      </summary>
      <fieldset class="exports" disabled={whole === null || !object?.isPlaced}>
        <legend class="visually-hidden">Poses, files and images</legend>
        {video.value !== null && whole !== null && object !== null && (
          <button type="button" onClick={() => exportAs("video", whole, object)}>
            JSON of all frames
          </button>
        )}
        {formats.map(([format, title]) => (
          <button
            key={format}
            type="button"
            onClick={() => whole !== null && object !== null && exportAs(format, whole, object)}
          >
            {title}
          </button>
        ))}
      </fieldset>
      {whole !== null && whole.sample === null && (
        <p class="quiet">The link contains the options but not your files.</p>
      )}
    </details>
  );
}
