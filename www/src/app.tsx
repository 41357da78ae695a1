/** The page. */
import { useEffect } from "preact/hooks";
import { listenToKeys } from "./commands/shortcuts.js";
import { draft } from "./input/draft.js";
import { AcceptSure, Decision } from "./panels/decision.js";
import { DropOverlay } from "./panels/drop-overlay.js";
import { Header, isHelpOpen, pageCommands, Tools } from "./panels/header.js";
import { InputPanel } from "./panels/input-panel.js";
import { HandPanel, OptionsPanel } from "./panels/lazy-panels.js";
import { ObjectsPanel } from "./panels/objects-panel.js";
import { ResultPanel } from "./panels/result-panel.js";
import { RunBar } from "./panels/run-bar.js";
import { SamplesPanel, StartPanel } from "./panels/start-panel.js";
import { page } from "./state/page.js";
import { lazy } from "./ui/lazy.js";
import { WorkspaceProvider } from "./ui/workspace.js";
import { ImageView } from "./views/image-view.js";
import { SpaceView } from "./views/space-view.js";

const { gizmo, isSettled, largeView, list, notKept, othersScenes, scene, space, video } = page;

const Intake = lazy(
  () => draft.value !== null,
  () => import("./intake/sheet.js").then(({ Sheet }) => Sheet),
);
const TimePanel = lazy(
  () => video.value !== null,
  () => import("./panels/time-panel.js").then(({ TimePanel }) => TimePanel),
);

const ExportPanel = lazy(
  () => isSettled.value,
  () => import("./panels/export-panel.js").then(({ ExportPanel }) => ExportPanel),
);
const ScenesPanel = lazy(
  () => list.value.length > 0,
  () => import("./panels/scene-list.js").then(({ ScenesPanel }) => ScenesPanel),
);

const StorageWarnings = lazy(
  () => notKept.value !== null || othersScenes.value.length > 0,
  () => import("./panels/storage-warnings.js").then(({ StorageWarnings }) => StorageWarnings),
);

const HelpDialog = lazy(
  () => isHelpOpen.value,
  () => import("./panels/help-dialog.js").then(({ HelpDialog }) => HelpDialog),
);

export function App() {
  useEffect(() => listenToKeys(page, globalThis, pageCommands), []);
  // Without a 3D view, the image view is the large one.
  const large = space.value.kind === "none" ? "image" : largeView.value;
  return (
    <WorkspaceProvider value={page}>
      <div class="frame">
        <Header />
        <main class="page" data-large={large} data-scene={scene.value?.name ?? ""} data-fixing={gizmo.value !== null}>
          {/* First, so that the Tab key reaches it first. */}
          <aside class="side" aria-label="Scene">
            <StorageWarnings />
            <RunBar />
            <StartPanel />
            <ObjectsPanel>
              <AcceptSure />
            </ObjectsPanel>
            <ResultPanel />
            <Decision />
          </aside>
          <SpaceView />
          <ImageView />
          <TimePanel />
          <div class="more-panels">
            <HandPanel />
            <ScenesPanel />
            <SamplesPanel />
            <ExportPanel />
            <InputPanel />
            <OptionsPanel />
          </div>
        </main>
        <Tools />
        <HelpDialog />
        <Intake />
        <DropOverlay />
      </div>
    </WorkspaceProvider>
  );
}
