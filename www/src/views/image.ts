/** What the image view draws: the scene with its objects, zoomed. */
import { computed, effect, type ReadonlySignal, signal } from "@preact/signals";
import { depthImage, depthRange } from "../pictures/colours.js";
import { compose, type DrawnObject, drawObject } from "../pictures/composition.js";
import { drawnScene } from "../pictures/reduced.js";
import { wholeImage, type Zoom, zoomToObjects } from "../pictures/zoom.js";
import { once } from "../state/inputs.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Workspace } from "../state/workspace.js";

/** The image of a workspace. */
export const imageOf = once((workspace: Workspace) => {
  const { isMeshShown, layers, scene, selected } = workspace;

  /** Depends on the scene only, so that it is not computed again when display settings change. */
  const onObjects = computed(() => (scene.value === null ? wholeImage : zoomToObjects(scene.value)));

  /** The scene at the size that is drawn. */
  const drawn = computed(() => (scene.value === null ? null : drawnScene(scene.value)));

  /** Depends on the scene only, too. */
  const depthColours = computed(() => drawn.value && depthImage(drawn.value.depthM));

  const base = computed(() => layers.value.base);

  /** What is behind the overlays, the photo or the depth map: red, green, blue, alpha, at the size that is drawn. */
  const ground = computed(() => {
    const rgba = drawn.value?.rgba ?? null;
    return base.value === "photo" && rgba !== null ? rgba : depthColours.value;
  });

  const groundImage = computed(() => {
    const [view, pixels] = [drawn.value, ground.value];
    return view && pixels && new ImageData(Uint8ClampedArray.from(pixels), view.width, view.height);
  });

  const depthRangeOfScene = computed(() => (scene.value === null ? null : depthRange(scene.value.depthM)));

  /** The objects at their start poses. */
  const before = computed(() => {
    const [whole, view] = [scene.value, drawn.value];
    return whole === null || view === null
      ? []
      : whole.objects.map((object) => drawObject(view, object, object.start.value.transform.matrix));
  });

  /** One signal per object, so that a changed pose renders one mesh only. */
  const renderings = computed<readonly ReadonlySignal<{ object: ObjectModel; drawn: DrawnObject }>[]>(() => {
    const [whole, view] = [scene.value, drawn.value];
    if (whole === null || view === null) return [];
    return whole.objects
      .filter(({ isShown }) => isShown.value)
      .map((object) =>
        computed(() => {
          const { matrix } = object.pose.value.transform;
          return { object, drawn: drawObject(view, object, isMeshShown(object) ? matrix : null) };
        }),
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

  function draw(canvas: HTMLCanvasElement): void {
    const [view, picture] = [drawn.value, ground.value];
    if (view === null || picture === null) return;
    if (canvas.width !== view.width || canvas.height !== view.height) {
      canvas.width = view.width;
      canvas.height = view.height;
    }
    const shown = layers.value;
    const image = compose(view, picture, shown.wipe > 0 ? before.value : [], after.value, shown, zoom.value);
    canvas.getContext("2d")?.putImageData(image, 0, 0);
  }

  /** The depth of the nearest mesh at a pixel of the scene, metres; infinite where there is none. */
  function meshDepthAt({ x, y }: { x: number; y: number }): number {
    const { width = 1, height = 1, step = 1, offset = 0 } = drawn.value ?? {};
    const at = (pixel: number, size: number) => Math.min(Math.max(Math.round((pixel - offset) / step), 0), size - 1);
    const place = at(y, height) * width + at(x, width);
    return Math.min(...after.value.map(({ depth }) => (depth[place] || Number.POSITIVE_INFINITY) as number));
  }

  return { after, depthRangeOfScene, draw, drawn, ground, groundImage, meshDepthAt, ownZoom, zoom };
});
