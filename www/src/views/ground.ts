/** The image behind the overlays: the photo or the depth map. */
import { computed } from "@preact/signals";
import { depthImage } from "../draw/colours.js";
import { layers } from "../state/display.js";
import { scene } from "../state/scene.js";

/** Depends on the scene only, so that it is not computed again when display settings change. */
const depth = computed(() => (scene.value === null ? null : depthImage(scene.value.depthM)));

const base = computed(() => layers.value.base);

/** Red, green, blue, alpha, at the size of the depth map. */
export const ground = computed(() => {
  const rgba = scene.value?.rgba ?? null;
  return base.value === "photo" && rgba !== null ? rgba : depth.value;
});

export const groundImage = computed(() => {
  const [whole, pixels] = [scene.value, ground.value];
  if (whole === null || pixels === null) return null;
  return new ImageData(Uint8ClampedArray.from(pixels), whole.width, whole.height);
});
