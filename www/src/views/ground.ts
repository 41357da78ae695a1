/** The image behind the overlays: the photo or the depth map. */
import { computed } from "@preact/signals";
import { depthImage } from "../draw/colours.js";
import { drawnScene } from "../draw/reduced.js";
import { once } from "../load/once.js";
import type { Workspace } from "../state/workspace.js";

/** What is behind the overlays of a workspace, as pixels and as an image. */
export const groundOf = once(({ layers, scene }: Workspace) => {
  /** Depends on the scene only, so that it is not computed again when display settings change. */
  const depth = computed(() => (scene.value === null ? null : depthImage(drawnScene(scene.value).depthM)));

  const base = computed(() => layers.value.base);

  /** Red, green, blue, alpha, at the size that is drawn. */
  const ground = computed(() => {
    const rgba = scene.value === null ? null : drawnScene(scene.value).rgba;
    return base.value === "photo" && rgba !== null ? rgba : depth.value;
  });

  const groundImage = computed(() => {
    const [whole, pixels] = [scene.value, ground.value];
    if (whole === null || pixels === null) return null;
    const { width, height } = drawnScene(whole);
    return new ImageData(Uint8ClampedArray.from(pixels), width, height);
  });

  return { ground, groundImage };
});
