/** What the library is given. */
import type { AlignInput } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";

/** An object of a scene, as an input. */
export const inputOf = ({ depthM, width, height, camera }: Scene, { mask, mesh }: ObjectModel): AlignInput => ({
  depth: depthM,
  width,
  height,
  camera,
  mask,
  mesh,
});
