/** Copies and saves results. */
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { permalink } from "../state/permalink.js";
import type { Scene } from "../state/scene.js";
import { imageSnapshot } from "../views/image-view.js";

const { announce, space } = page;

export type Format =
  | "columns"
  | "rows"
  | "json"
  | "bop"
  | "session"
  | "video"
  | "scene"
  | "glb"
  | "ply"
  | "png"
  | "link";

/** Copies or saves the object, or the whole scene for JSON and BOP. The writers of files are loaded on demand. */
export async function exportAs(format: Format, scene: Scene, object: ObjectModel): Promise<void> {
  const name = fileName(object.name);
  if (format === "link") return copy(permalink(), "the link");
  if (format === "png") return saveImage(name);
  if (format === "session") {
    const file = await (await import("../session/index.js")).sessionFile();
    return file === null ? undefined : download(`${fileName(scene.name)}.sim3align.zip`, file, "application/zip");
  }
  const { bopText, glbBytes, jsonText, matrixText, plyBytes, sceneBytes, videoText } = await import("./files.js");
  switch (format) {
    case "columns":
      return copy(matrixText(object, "columns"), "the matrix (column-major)");
    case "rows":
      return copy(matrixText(object, "rows"), "the matrix (row-major)");
    case "json":
      return download(`${name}.json`, jsonText(scene), "application/json");
    case "bop":
      return download("scene_gt.json", bopText(scene), "application/json");
    case "video":
      return download(`${name}-frames.json`, videoText(object.name), "application/json");
    case "scene":
      return download("scene.glb", sceneBytes(scene), "model/gltf-binary");
    case "glb":
      return download(`${name}-placed.glb`, glbBytes(object), "model/gltf-binary");
    case "ply":
      return download(`${name}-placed.ply`, plyBytes(object));
  }
}

/** Saves the 3D view or, without one, the image view. */
async function saveImage(name: string): Promise<void> {
  const state = space.peek();
  const image = state.kind === "ready" ? await state.view.snapshot() : await imageSnapshot(page);
  if (image === null) announce("There is no image yet.", "failed");
  else download(`${name}-view.png`, image, "image/png");
}

function download(name: string, content: string | Uint8Array | Blob, type = "application/octet-stream"): void {
  const part = typeof content === "string" || content instanceof Blob ? content : Uint8Array.from(content);
  const address = URL.createObjectURL(new Blob([part], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  // Browsers tell nobody when a download has started, and revoking the address earlier could cancel it.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
  announce(`Saved ${name}.`);
}

async function copy(text: string, what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    announce(`Copied ${what}.`);
  } catch {
    announce(`The browser blocked copying ${what}.`, "failed");
  }
}

/** A name that is valid on all file systems. */
const fileName = (name: string): string =>
  name
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "") || "object";
