/** The 3D view of the observation and the aligned meshes. Only this folder imports three.js; the page loads it lazily. */
import { SceneView } from "./scene-view.js";
import { Stage } from "./stage.js";
import type { View, ViewEvents, ViewOptions } from "./types.js";

/**
 * Creates a view that fills its host element.
 * @throws {NoGraphics} if the browser supports neither WebGPU nor WebGL 2
 */
export async function createView(host: HTMLElement, events: ViewEvents, options: ViewOptions = {}): Promise<View> {
  return new SceneView(await Stage.create(host, options.forceWebGL === true), host, events);
}
