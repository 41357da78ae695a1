/** The frame of the 3D view: its canvas and its controls. */
import { useEffect, useRef } from "preact/hooks";
import { samples, sampleUrl } from "../opening/samples.js";
import type { Display3d } from "../state/display.js";
import { Check, Menu, Picture } from "../ui/controls.js";
import { useWorkspace } from "../ui/workspace.js";
import { imageOf } from "./image.js";

const switches: readonly [name: "cloud" | "mesh" | "wireframe" | "dimensions" | "planes", title: string][] = [
  ["cloud", "Points"],
  ["mesh", "Mesh"],
  ["wireframe", "Wireframe"],
  ["dimensions", "Sizes"],
  ["planes", "Top, side and front"],
];

const viewpoints = [
  ["camera", "Camera"],
  ["orbit", "Three-quarter"],
  ["top", "Top"],
  ["side", "Side"],
] as const;

export function SpaceView() {
  const workspace = useWorkspace();
  const { display3d, isSettled, showsBefore, space } = workspace;
  const set = (change: Partial<Display3d>) => {
    display3d.value = { ...display3d.peek(), ...change };
  };
  const host = useRef<HTMLDivElement>(null);
  const isWanted = isSettled.value;
  useEffect(() => {
    const shown = new AbortController();
    const own = host.current;
    if (isWanted && own !== null) {
      import("./space.js").then(
        ({ mountSpace }) => mountSpace(workspace, own, shown.signal),
        () => {
          space.value = { kind: "none", reason: "The 3D view could not be loaded." };
        },
      );
    }
    return () => shown.abort();
  }, [workspace, isWanted]);
  const state = space.value;
  const { pointSize } = display3d.value;
  const viewpointButton = ([from, title]: (typeof viewpoints)[number]) => (
    <button
      key={from}
      type="button"
      onClick={() => state.kind === "ready" && state.view.lookFrom(from, from === "camera")}
    >
      {title}
    </button>
  );
  return (
    <section class="view space" part="space" aria-labelledby="space-title" data-state={state.kind}>
      <div class="row view-head">
        <h2 id="space-title">3D</h2>
        <Menu title="View" label="View of the 3D scene">
          <fieldset disabled={state.kind !== "ready"}>
            <legend>Viewpoint</legend>
            {viewpoints.map(viewpointButton)}
          </fieldset>
          <fieldset disabled={state.kind !== "ready"}>
            <legend>Layers</legend>
            {switches.map(([name, title]) => (
              <Check
                key={name}
                title={title}
                checked={display3d.value[name]}
                onCheck={(checked) => set({ [name]: checked })}
              />
            ))}
            <label class="check points">
              <span>Point size</span>
              <input
                id="point-size"
                type="range"
                min="0.4"
                max="3"
                step="0.2"
                value={pointSize}
                onInput={({ currentTarget }) => set({ pointSize: currentTarget.valueAsNumber })}
              />
            </label>
          </fieldset>
          <fieldset disabled={state.kind !== "ready"}>
            <legend>Compare</legend>
            <button
              type="button"
              aria-pressed={showsBefore.value}
              onClick={() => {
                showsBefore.value = !showsBefore.peek();
              }}
            >
              Before
            </button>
          </fieldset>
        </Menu>
      </div>
      <div class="view-host" ref={host} data-backend={state.kind === "ready" ? state.view.backend : undefined}>
        {state.kind === "loading" && <Preview />}
        {state.kind === "none" && (
          <p class="view-note" role="note">
            {state.reason} All results are shown in the image view.
          </p>
        )}
      </div>
    </section>
  );
}

/** The address of the photo of the sample that the page opens first. */
function firstPhoto(sampleId: string | null): string | null {
  const photo = samples.find(({ id }) => id === sampleId)?.photo;
  return photo === undefined ? null : sampleUrl(photo);
}

/** The photo or the depth map, until the 3D view is there. */
function Preview() {
  const workspace = useWorkspace();
  const image = imageOf(workspace).groundImage.value;
  const photo = firstPhoto(workspace.inputs.value.sample);
  if (image === null && photo !== null) return <img class="preview" src={photo} alt="" />;
  const { text, kind } = workspace.status.value;
  return image === null ? (
    <p class="view-note">{kind === "failed" ? text : kind === "working" ? "Reading …" : "No scene"}</p>
  ) : (
    <Picture image={image} label="The scene; the 3D view is loading" class="preview" />
  );
}
