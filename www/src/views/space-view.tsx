/** The frame of the 3D view: its canvas and its controls. */
import { useEffect, useRef } from "preact/hooks";
import { inputs } from "../load/open.js";
import { samples, sampleUrl } from "../load/samples.js";
import { type Display3d, display3d, measured, showsBefore } from "../state/display.js";
import { centimetres } from "../ui/format.js";
import { Picture } from "../ui/picture.js";
import { groundImage } from "./ground.js";
import { isSettled, mountSpace, space } from "./space.js";

const switches: readonly [name: "cloud" | "mesh" | "wireframe" | "dimensions", title: string][] = [
  ["cloud", "Points"],
  ["mesh", "Mesh"],
  ["wireframe", "Wireframe"],
  ["dimensions", "Sizes"],
];

const viewpoints = [
  ["camera", "Camera"],
  ["orbit", "Three-quarter"],
  ["top", "Top"],
  ["side", "Side"],
] as const;

const set = (change: Partial<Display3d>) => {
  display3d.value = { ...display3d.peek(), ...change };
};

export function SpaceView() {
  const host = useRef<HTMLDivElement>(null);
  const isWanted = isSettled.value;
  useEffect(() => {
    if (isWanted && host.current !== null) mountSpace(host.current);
  }, [isWanted]);
  const state = space.value;
  const { pointSize } = display3d.value;
  return (
    <section class="view space" aria-labelledby="space-title" data-state={state.kind}>
      <div class="view-head">
        <h2 id="space-title">3D</h2>
        <fieldset disabled={state.kind !== "ready"}>
          <legend class="visually-hidden">Layers of the 3D view</legend>
          {switches.map(([name, title]) => (
            <label key={name} class="check">
              <input
                type="checkbox"
                checked={display3d.value[name]}
                onChange={({ currentTarget }) => set({ [name]: currentTarget.checked })}
              />
              <span>{title}</span>
            </label>
          ))}
          <label class="check points">
            <span>Size</span>
            <input
              type="range"
              min="0.4"
              max="3"
              step="0.2"
              value={pointSize}
              aria-label="Point size"
              onInput={({ currentTarget }) => set({ pointSize: currentTarget.valueAsNumber })}
            />
          </label>
        </fieldset>
        <fieldset disabled={state.kind !== "ready"}>
          <legend class="visually-hidden">Compare and measure</legend>
          <button
            type="button"
            aria-pressed={showsBefore.value}
            onClick={() => {
              showsBefore.value = !showsBefore.peek();
            }}
          >
            Before
          </button>
          <button
            type="button"
            id="measure"
            aria-pressed={measured.value !== null}
            onClick={() => {
              measured.value = measured.peek() === null ? [] : null;
            }}
          >
            Measure
          </button>
          {measured.value !== null && <output id="measured">{measuredText(measured.value)}</output>}
        </fieldset>
        <fieldset class="viewpoints" disabled={state.kind !== "ready"}>
          <legend class="visually-hidden">Viewpoint</legend>
          {viewpoints.map(([from, title]) => (
            <button
              key={from}
              type="button"
              onClick={() => state.kind === "ready" && state.view.lookFrom(from, from === "camera")}
            >
              {title}
            </button>
          ))}
        </fieldset>
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

/** The distance of the measured points, or what to do. */
function measuredText(points: readonly (readonly [number, number, number])[]): string {
  const [from, to] = points;
  if (from === undefined) return "Click a point in either view.";
  if (to === undefined) return "Click a second point.";
  return `${centimetres(Math.hypot(...from.map((x, k) => x - (to[k] ?? 0))))} cm`;
}

/** The address of the photo of the sample that the page opens first. */
function firstPhoto(): string | null {
  const photo = samples.find(({ id }) => id === inputs.value.sample)?.photo;
  return photo === undefined ? null : sampleUrl(photo);
}

/** The photo or the depth map, until the 3D view is there. */
function Preview() {
  const image = groundImage.value;
  const photo = firstPhoto();
  if (image === null && photo !== null) return <img class="preview" src={photo} alt="" />;
  return image === null ? (
    <p class="view-note">Reading …</p>
  ) : (
    <Picture image={image} label="The scene; the 3D view is loading" class="preview" />
  );
}
