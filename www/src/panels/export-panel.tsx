/** What leaves the page. */
import { exportAs, type Format } from "../export/formats.js";
import { scene, selected } from "../state/scene.js";

const formats: readonly [format: Format, title: string][] = [
  ["columns", "Matrix, columns"],
  ["rows", "Matrix, rows"],
  ["json", "JSON"],
  ["bop", "BOP JSON"],
  ["glb", "GLB"],
  ["ply", "PLY"],
  ["png", "PNG of view"],
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
        <legend class="visually-hidden">Poses, files and pictures</legend>
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
        <p class="quiet">A link holds the options, and not your own files: these stay here.</p>
      )}
    </details>
  );
}
