/** The image view: photo or depth map, overlaid with masks, silhouettes and depth differences. */
import { computed, effect, type ReadonlySignal, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { depthGradient, depthRange } from "../draw/colours.js";
import { compose, type DrawnObject, differenceLimit, drawObject } from "../draw/composition.js";
import { clampedZoom, wholeImage, type Zoom, zoomToObjects } from "../draw/zoom.js";
import { hoveredPixel, layers, measure, setLayer } from "../state/display.js";
import type { ObjectModel } from "../state/object-model.js";
import { objectAt, scene, select, selected } from "../state/scene.js";
import { ground } from "./ground.js";
import { space } from "./space.js";

/** Depends on the scene only, so that it is not computed again when display settings change. */
const onObjects = computed(() => (scene.value === null ? wholeImage : zoomToObjects(scene.value)));

const depthRangeOfScene = computed(() => (scene.value === null ? null : depthRange(scene.value.depthM)));

/** The objects at their start poses. */
const before = computed(() => {
  const whole = scene.value;
  return whole === null ? [] : whole.objects.map((object) => drawObject(whole, object, object.start.transform.matrix));
});

/** One signal per object, so that a changed pose renders one mesh only. */
const renderings = computed<readonly ReadonlySignal<{ object: ObjectModel; drawn: DrawnObject }>[]>(() => {
  const whole = scene.value;
  if (whole === null) return [];
  return whole.objects
    .filter(({ isShown }) => isShown.value)
    .map((object) =>
      computed(() => ({ object, drawn: drawObject(whole, object, object.pose.value.transform.matrix) })),
    );
});

/** The objects at their current poses. */
const after = computed<readonly DrawnObject[]>(() =>
  renderings.value.map(({ value: { object, drawn } }) => ({ ...drawn, isSelected: object === selected.value })),
);

/** The zoom that wheel and drag have set, for one scene and one setting of “Zoom”. */
const ownZoom = signal<Zoom | null>(null);

const zoom = computed(() => ownZoom.value ?? (layers.value.zoom ? onObjects.value : wholeImage));

effect(() => {
  void [scene.value, layers.value.zoom];
  ownZoom.value = null;
});

let shownCanvas: HTMLCanvasElement | null = null;

/** The image view as a PNG. */
export function imageSnapshot(): Promise<Blob | null> {
  return new Promise((resolve) => (shownCanvas === null ? resolve(null) : shownCanvas.toBlob(resolve)));
}

function draw(canvas: HTMLCanvasElement): void {
  const [whole, picture] = [scene.value, ground.value];
  if (whole === null || picture === null) return;
  if (canvas.width !== whole.width || canvas.height !== whole.height) {
    canvas.width = whole.width;
    canvas.height = whole.height;
  }
  const shown = layers.value;
  const image = compose(whole, picture, shown.wipe > 0 ? before.value : [], after.value, shown, zoom.value);
  canvas.getContext("2d")?.putImageData(image, 0, 0);
}

const switches: readonly [name: "outline" | "silhouette" | "difference" | "zoom", title: string][] = [
  ["outline", "Mask"],
  ["silhouette", "Silhouette"],
  ["difference", "Depth difference"],
  ["zoom", "Zoom"],
];

export function ImageView() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    shownCanvas = canvas.current;
    let frame = 0;
    // The browser clears the canvas when the graphics device is lost.
    const redraw = () => canvas.current !== null && draw(canvas.current);
    canvas.current?.addEventListener("contextrestored", redraw);
    const stop = effect(() => {
      // Reading these signals subscribes to them. All changes within a frame cause one drawing.
      void [scene.value, ground.value, layers.value, zoom.value, after.value];
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(redraw);
    });
    return () => {
      stop();
      cancelAnimationFrame(frame);
      shownCanvas?.removeEventListener("contextrestored", redraw);
      shownCanvas = null;
    };
  }, []);
  const whole = scene.value;
  const { base: shownBase, wipe, difference } = layers.value;
  const ratio = whole === null ? 4 / 3 : whole.width / whole.height;
  const { factor, x, y } = zoom.value;
  const limit = selected.value === null ? null : 1000 * differenceLimit(selected.value);
  return (
    <section class="view image" aria-labelledby="image-title">
      <div class="view-head">
        <h2 id="image-title">Image</h2>
        <fieldset>
          <legend class="visually-hidden">Layers of the image view</legend>
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
          {switches.map(([name, title]) => (
            <label key={name} class="check">
              <input
                id={`layer-${name}`}
                type="checkbox"
                checked={layers.value[name]}
                onChange={({ currentTarget }) => setLayer(name, currentTarget.checked)}
              />
              <span>{title}</span>
            </label>
          ))}
        </fieldset>
      </div>
      <div class="view-host">
        <div class="picture" style={{ "--ratio": ratio, "--zoom": factor, "--x": x, "--y": y }}>
          <canvas
            ref={canvas}
            role="img"
            aria-label={description()}
            width={whole?.width ?? 640}
            height={whole?.height ?? 480}
            onPointerDown={startDrag}
            onPointerMove={(event) => (event.buttons === 0 ? hover(pixelOf(event)) : drag(event))}
            onWheel={wheel}
            onPointerLeave={() => hover(null)}
            onClick={focusOn}
          />
          <Cross />
        </div>
      </div>
      <div class="image-foot">
        <label class="wipe">
          <span>Before</span>
          <input
            id="wipe"
            type="range"
            min="0"
            max="1"
            step="0.01"
            value={wipe}
            aria-label="Share of the view that shows the start poses"
            onInput={({ currentTarget }) => setLayer("wipe", currentTarget.valueAsNumber)}
          />
          <span>After</span>
        </label>
        {difference && limit !== null ? (
          <p class="legend">
            <span>{limit} mm nearer</span>
            <span class="legend-bar" />
            <span>{limit} mm farther</span>
          </p>
        ) : (
          <Readout />
        )}
        <DepthLegend />
      </div>
    </section>
  );
}

function description(): string {
  const whole = scene.value;
  if (whole === null) return "No image yet";
  const names = whole.objects.map((object) => `${object.name}${object.isPlaced ? " (mesh placed)" : ""}`);
  return `${layers.value.base === "photo" ? "Photo" : "Depth map"} of ${whole.name}, with ${names.join(", ")}`;
}

type Pixel = { x: number; y: number };

function pixelOf(event: MouseEvent): Pixel | null {
  const canvas = event.currentTarget as HTMLCanvasElement;
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const x = Math.floor(((event.clientX - left) * canvas.width) / width);
  const y = Math.floor(((event.clientY - top) * canvas.height) / height);
  return x >= 0 && y >= 0 && x < canvas.width && y < canvas.height ? { x, y } : null;
}

/** Where a drag began; whether the pointer has moved since. */
let dragFrom: { clientX: number; clientY: number; zoom: Zoom } | null = null;
let hasDragged = false;
/** Smaller movements are clicks, in CSS pixels. */
const CLICK_PX = 4;

function startDrag({ clientX, clientY }: PointerEvent): void {
  hasDragged = false;
  dragFrom = { clientX, clientY, zoom: zoom.peek() };
}

/** Moves the part of the image that is shown. */
function drag(event: PointerEvent): void {
  if (dragFrom === null || dragFrom.zoom.factor <= 1) return;
  const [dx, dy] = [event.clientX - dragFrom.clientX, event.clientY - dragFrom.clientY];
  if (!hasDragged && Math.hypot(dx, dy) < CLICK_PX) return;
  hasDragged = true;
  const { width, height } = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
  const { factor, x, y } = dragFrom.zoom;
  ownZoom.value = clampedZoom({ factor, x: x - dx / width, y: y - dy / height });
}

/** Zooms at the pointer. */
function wheel(event: WheelEvent): void {
  event.preventDefault();
  const { left, top, width, height } = (event.currentTarget as HTMLCanvasElement).getBoundingClientRect();
  const { factor, x, y } = zoom.peek();
  const next = Math.min(Math.max(factor * Math.exp(-0.0015 * event.deltaY), 1), 24);
  // What is under the pointer stays there.
  const at = [(event.clientX - left) / width, (event.clientY - top) / height] as const;
  const kept = (centre: number, share: number) => share + ((centre - share) * factor) / next;
  ownZoom.value = clampedZoom({ factor: next, x: kept(x, at[0]), y: kept(y, at[1]) });
}

/** Selects the clicked object, and centres the 3D view on the clicked point. */
function focusOn(event: MouseEvent): void {
  const [pixel, state] = [pixelOf(event), space.peek()];
  if (pixel === null || hasDragged) return;
  const point = pointAt(pixel);
  if (point !== null && measure(point)) return;
  select(objectAt(pixel.x, pixel.y)?.id ?? null);
  if (state.kind === "ready" && point !== null) state.view.focus(point);
}

/** Marks a pixel in both views. */
function hover(pixel: Pixel | null): void {
  hoveredPixel.value = pixel;
  const state = space.peek();
  if (state.kind === "ready") state.view.mark(pixel === null ? null : pointAt(pixel));
}

/** The back-projected depth reading of a pixel: camera frame, metres. */
function pointAt({ x, y }: Pixel): [number, number, number] | null {
  const whole = scene.peek();
  const z = whole?.depthM[y * whole.width + x] ?? 0;
  if (whole === null || !(z > 0)) return null;
  const { fx, fy, cx, cy } = whole.camera;
  return [((x - cx) * z) / fx, ((y - cy) * z) / fy, z];
}

/** Marks the hovered pixel. */
function Cross() {
  const [pixel, whole] = [hoveredPixel.value, scene.value];
  if (pixel === null || whole === null) return null;
  const [left, top] = [(100 * (pixel.x + 0.5)) / whole.width, (100 * (pixel.y + 0.5)) / whole.height];
  return <span class="cross" style={{ left: `${left}%`, top: `${top}%` }} />;
}

/** What the colours of the depth map mean. */
function DepthLegend() {
  const range = depthRangeOfScene.value;
  if (layers.value.base !== "depth" || range === null) return null;
  return (
    <p class="legend" id="depth-legend">
      <span>{range.nearM.toFixed(2)} m</span>
      <span class="legend-bar" style={{ background: depthGradient }} />
      <span>{range.farM.toFixed(2)} m</span>
    </p>
  );
}

/** Depth of the scene and of the mesh at the hovered pixel. */
function Readout() {
  const [pixel, whole] = [hoveredPixel.value, scene.value];
  if (pixel === null || whole === null) return <p class="readout quiet">Hover over the image to read its depth.</p>;
  const at = pixel.y * whole.width + pixel.x;
  const measured = whole.depthM[at] ?? 0;
  const mesh = Math.min(...after.value.map(({ depth }) => (depth[at] || Number.POSITIVE_INFINITY) as number));
  const difference = measured > 0 && Number.isFinite(mesh) ? 1000 * (mesh - measured) : null;
  return (
    <p class="readout">
      {pixel.x}, {pixel.y}: {measured > 0 ? `${measured.toFixed(3)} m` : "no reading"}
      {difference !== null && `, mesh ${difference < 0 ? "−" : "+"}${Math.abs(difference).toFixed(1)} mm`}
    </p>
  );
}
