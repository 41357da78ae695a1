/**
 * The 3D view of an observation and of the meshes aligned with it. Everything that imports three.js is in this folder;
 * the page imports it lazily.
 */
import { SceneView } from "./scene-view.js";
import { Stage } from "./stage.js";
import type { View, ViewEvents, ViewOptions } from "./types.js";

/**
 * Makes a view that fills its host.
 * @throws {NoGraphics} where there is neither WebGPU nor WebGL 2
 */
export async function createView(host: HTMLElement, events: ViewEvents, options: ViewOptions = {}): Promise<View> {
  return new SceneView(await Stage.create(host, options.forceWebGL === true), host, events);
}
