/** The image view: photo or depth map, overlaid with masks, silhouettes and depth differences. */
import { effect } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import { differenceLimit } from "sim3align/pictures/colours";
import { depthGradient } from "../pictures/colours.js";
import type { Workspace } from "../state/workspace.js";
import { Check, Menu } from "../ui/controls.js";
import { depth, percent, small } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";
import { imageOf } from "./image.js";
import { pointerOf } from "./image-pointer.js";

/** The image view as a PNG. */
export function imageSnapshot({ imageCanvas }: Workspace): Promise<Blob | null> {
  return new Promise((resolve) => {
    const canvas = imageCanvas.peek();
    if (canvas === null) resolve(null);
    else canvas.toBlob(resolve);
  });
}

const switches: readonly [name: "outline" | "silhouette" | "difference" | "zoom", title: string][] = [
  ["outline", "Mask"],
  ["silhouette", "Silhouette"],
  ["difference", "Depth difference"],
  ["zoom", "Zoom"],
];

export function ImageView() {
  const workspace = useWorkspace();
  const { imageCanvas, layers, scene, selected, setLayer, unit } = workspace;
  const { after, draw, drawn, ground, zoom } = imageOf(workspace);
  const { hover, focusOn, startDrag, move, wheel } = useMemo(() => pointerOf(workspace), [workspace]);
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const own = canvas.current;
    imageCanvas.value = own;
    let frame = 0;
    // The browser clears the canvas when the graphics device is lost.
    const redraw = () => canvas.current !== null && draw(canvas.current);
    own?.addEventListener("contextrestored", redraw);
    const stop = effect(() => {
      // Reading these signals subscribes to them. All changes within a frame cause one drawing.
      void [scene.value, ground.value, layers.value, zoom.value, after.value];
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(redraw);
    });
    return () => {
      stop();
      cancelAnimationFrame(frame);
      own?.removeEventListener("contextrestored", redraw);
      imageCanvas.value = null;
    };
  }, [workspace]);
  const whole = scene.value;
  const { base: shownBase, wipe, difference } = layers.value;
  const ratio = whole === null ? 4 / 3 : whole.width / whole.height;
  const { factor, x, y } = zoom.value;
  const limit = selected.value && small(differenceLimit(selected.value.visible.value.sizeM), unit.value);
  return (
    <section class="view image" part="image" aria-labelledby="image-title">
      <div class="row view-head">
        <h2 id="image-title">Image</h2>
        <Menu title="Layers" label="Layers of the image">
          <label class="field-inline">
            <span>Background</span>
            <select
              aria-label="Background"
              value={shownBase}
              onChange={({ currentTarget }) => setLayer("base", currentTarget.value as "photo" | "depth")}
            >
              <option value="photo" disabled={whole?.rgba === null}>
                Photo
              </option>
              <option value="depth">Depth</option>
            </select>
          </label>
          {switches.map(([name, title]) => (
            <Check
              key={name}
              id={`layer-${name}`}
              title={title}
              checked={layers.value[name]}
              onCheck={(checked) => setLayer(name, checked)}
            />
          ))}
        </Menu>
      </div>
      <div class="view-host">
        <div class="picture" style={{ "--ratio": ratio, "--zoom": factor, "--x": x, "--y": y }}>
          <canvas
            ref={canvas}
            role="img"
            aria-label={descriptionOf(workspace)}
            width={drawn.value?.width ?? 640}
            height={drawn.value?.height ?? 480}
            onPointerDown={startDrag}
            onPointerMove={move}
            onWheel={wheel}
            onPointerLeave={() => hover(null)}
            onClick={focusOn}
          />
          <Cross />
        </div>
      </div>
      <div class="row image-foot">
        <label class="row wipe">
          <span>{wipe <= 0 ? "Result" : wipe >= 1 ? "Before" : "Before | result"}</span>
          <input
            id="wipe"
            type="range"
            min="0"
            max="1"
            step="0.01"
            value={wipe}
            aria-label="Compare: the share of the picture that is as before"
            aria-valuetext={`${percent(wipe)} before, ${percent(1 - wipe)} result`}
            onInput={({ currentTarget }) => setLayer("wipe", currentTarget.valueAsNumber)}
          />
        </label>
        {difference && limit !== null ? (
          <p class="row legend">
            <span>{limit} nearer</span>
            <span class="legend-bar" />
            <span>{limit} farther</span>
          </p>
        ) : (
          <Readout />
        )}
        <DepthLegend />
      </div>
    </section>
  );
}

function descriptionOf({ layers, scene }: Workspace): string {
  const whole = scene.value;
  if (whole === null) return "No image yet";
  const names = whole.objects.map((object) => `${object.name}${object.isPlaced ? " (mesh placed)" : ""}`);
  return `${layers.value.base === "photo" ? "Photo" : "Depth map"} of ${whole.name}, with ${names.join(", ")}`;
}

/** Marks the hovered pixel. */
function Cross() {
  const { hoveredPixel, scene } = useWorkspace();
  const [pixel, whole] = [hoveredPixel.value, scene.value];
  if (pixel === null || whole === null) return null;
  const [left, top] = [(100 * (pixel.x + 0.5)) / whole.width, (100 * (pixel.y + 0.5)) / whole.height];
  return <span class="cross" style={{ left: `${left}%`, top: `${top}%` }} />;
}

/** What the colours of the depth map mean. */
function DepthLegend() {
  const workspace = useWorkspace();
  const range = imageOf(workspace).depthRangeOfScene.value;
  if (workspace.layers.value.base !== "depth" || range === null) return null;
  const unit = workspace.unit.value;
  return (
    <p class="row legend" id="depth-legend">
      <span>{depth(range.nearM, unit)}</span>
      <span class="legend-bar" style={{ background: depthGradient }} />
      <span>{depth(range.farM, unit)}</span>
    </p>
  );
}

/** Depth of the scene and of the mesh at the hovered pixel. */
function Readout() {
  const workspace = useWorkspace();
  const { hoveredPixel, scene } = workspace;
  const [pixel, whole, unit] = [hoveredPixel.value, scene.value, workspace.unit.value];
  if (pixel === null || whole === null) return <p class="readout quiet">Hover over the image to read its depth.</p>;
  const at = pixel.y * whole.width + pixel.x;
  const measured = whole.depthM[at] ?? 0;
  const mesh = imageOf(workspace).meshDepthAt(pixel);
  const difference = measured > 0 && Number.isFinite(mesh) ? mesh - measured : null;
  return (
    <p class="readout">
      {pixel.x}, {pixel.y}: {measured > 0 ? depth(measured, unit, 3) : "no reading"}
      {difference !== null && `, mesh ${difference < 0 ? "−" : "+"}${small(Math.abs(difference), unit)}`}
    </p>
  );
}
