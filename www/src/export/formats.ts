/** Everything that can be taken along. */
import { say } from "../state/announcement.js";
import type { ObjectModel } from "../state/object-model.js";
import { permalink } from "../state/permalink.js";
import type { Scene } from "../state/scene.js";
import { imageSnapshot } from "../views/image-view.js";
import { space } from "../views/space.js";
import { copy, download, fileName } from "./download.js";

export type Format = "columns" | "rows" | "json" | "bop" | "glb" | "ply" | "png" | "link";

/** Copies or saves an object, or its whole scene, in a format. What writes the files loads when it is wanted. */
export async function exportAs(format: Format, scene: Scene, object: ObjectModel): Promise<void> {
  const name = fileName(object.name);
  if (format === "link") return copy(permalink(), "the link");
  if (format === "png") return savePicture(name);
  const { bopText, glbBytes, jsonText, matrixText, plyBytes } = await import("./files.js");
  switch (format) {
    case "columns":
      return copy(matrixText(object, "columns"), "the matrix, column by column");
    case "rows":
      return copy(matrixText(object, "rows"), "the matrix, row by row");
    case "json":
      return download(`${name}.json`, jsonText(scene), "application/json");
    case "bop":
      return download("scene_gt.json", bopText(scene), "application/json");
    case "glb":
      return download(`${name}-placed.glb`, glbBytes(object), "model/gltf-binary");
    case "ply":
      return download(`${name}-placed.ply`, plyBytes(object));
  }
}

/** The 3D view as it is seen or, where there is none, the image. */
async function savePicture(name: string): Promise<void> {
  const state = space.peek();
  const picture = state.kind === "ready" ? await state.view.snapshot() : await imageSnapshot();
  if (picture === null) say("There is no picture yet.", "failed");
  else download(`${name}-view.png`, picture, "image/png");
}
