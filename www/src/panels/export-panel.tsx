/** What leaves the page. */
import { copy, download, fileName } from "../export/download.js";
import { bopText, glbBytes, jsonText, matrixText, plyBytes } from "../export/files.js";
import { say } from "../state/announcement.js";
import { permalink } from "../state/permalink.js";
import { scene, selected } from "../state/scene.js";
import { imageSnapshot } from "../views/image-view.js";
import { space } from "../views/space.js";

export function ExportPanel() {
  const [whole, object, state] = [scene.value, selected.value, space.value];
  const isReady = whole && object?.isPlaced;
  const name = fileName(object?.name ?? "object");

  const savePicture = async () => {
    const picture = state.kind === "ready" ? await state.view.snapshot() : await imageSnapshot();
    if (picture === null) say("There is no picture yet.", "failed");
    else download(`${name}-view.png`, picture, "image/png");
  };
  return (
    <details class="panel export-panel" open>
      <summary>
        <h2>Take along</h2>
      </summary>
      <fieldset class="exports" disabled={!isReady}>
        <legend class="visually-hidden">Poses, files and pictures</legend>
        <button
          type="button"
          onClick={() => object && copy(matrixText(object, "columns"), "the matrix, column by column")}
        >
          Matrix, columns
        </button>
        <button type="button" onClick={() => object && copy(matrixText(object, "rows"), "the matrix, row by row")}>
          Matrix, rows
        </button>
        <button type="button" onClick={() => whole && download(`${name}.json`, jsonText(whole), "application/json")}>
          JSON
        </button>
        <button type="button" onClick={() => whole && download("scene_gt.json", bopText(whole), "application/json")}>
          BOP JSON
        </button>
        <button
          type="button"
          onClick={() => object && download(`${name}-placed.glb`, glbBytes(object), "model/gltf-binary")}
        >
          GLB
        </button>
        <button type="button" onClick={() => object && download(`${name}-placed.ply`, plyBytes(object))}>
          PLY
        </button>
        <button type="button" onClick={savePicture}>
          PNG of view
        </button>
        <button type="button" onClick={() => copy(permalink(), "the link")}>
          Copy link
        </button>
      </fieldset>
      {whole !== null && whole.sample === null && (
        <p class="quiet">A link holds the options, and not your own files: these stay here.</p>
      )}
    </details>
  );
}
