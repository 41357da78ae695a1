/** The content of an element: the views and panels of the page, without those for files. */
import { HandPanel, OptionsPanel } from "../panels/lazy-panels.js";
import { ObjectsPanel } from "../panels/objects-panel.js";
import { ResultPanel } from "../panels/result-panel.js";
import { RunBar } from "../panels/run-bar.js";
import { useWorkspace } from "../ui/workspace.js";
import { ImageView } from "../views/image-view.js";
import { SpaceView } from "../views/space-view.js";

export function Embedded() {
  const { isReadonly, largeView, scene, space, status } = useWorkspace();
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
        {canChange ? <RunBar /> : <p role="status">{status.value.kind === "failed" ? status.value.text : ""}</p>}
        <ObjectsPanel />
        <ResultPanel />
        {canChange && (
          <>
            <HandPanel />
            <OptionsPanel />
          </>
        )}
      </div>
    </div>
  );
}
