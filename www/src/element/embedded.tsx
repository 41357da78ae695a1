/** The content of an element: the views and panels of the page, without those for files. */
import { Decision } from "../panels/decision.js";
import { HandPanel, OptionsPanel } from "../panels/lazy-panels.js";
import { ObjectsPanel } from "../panels/objects-panel.js";
import { ResultPanel } from "../panels/result-panel.js";
import { RunBar } from "../panels/run-bar.js";
import type { ObjectModel } from "../state/object-model.js";
import { useWorkspace } from "../ui/workspace.js";
import { ImageView } from "../views/image-view.js";
import { SpaceView } from "../views/space-view.js";

/** What a read-only scene says that has no poses, and is not aligned. */
const unplacedText = (objects: readonly ObjectModel[]) =>
  objects.length === 0 || objects.some(({ isPlaced }) => isPlaced) ? "" : "No pose is set, so no mesh is shown.";

export function Embedded() {
  const { isReadonly, largeView, objects, scene, space, status } = useWorkspace();
  const canChange = !isReadonly.value;
  return (
    <div
      class="embedded"
      data-large={space.value.kind === "none" ? "image" : largeView.value}
      data-scene={scene.value?.name ?? ""}
    >
      <SpaceView />
      <ImageView />
      <div class="side" part="side">
        {canChange ? (
          <RunBar />
        ) : (
          <p role="status">{status.value.kind === "failed" ? status.value.text : unplacedText(objects.value)}</p>
        )}
        <ObjectsPanel />
        <ResultPanel />
        {canChange && (
          <>
            <HandPanel />
            <OptionsPanel />
            <Decision />
          </>
        )}
      </div>
    </div>
  );
}
