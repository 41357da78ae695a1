/** Copies and saves results. */
import { extension } from "../input/files.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { permalink } from "../state/permalink.js";
import type { Scene } from "../state/scene.js";
import { isMetric } from "../state/scene.js";
import { imageSnapshot } from "../views/image-view.js";

const { announce, list, scene, space } = page;

/** A way to save or copy the object or the whole scene: the title of its button, and what it does. */
export type Export = readonly [title: string, act: (scene: Scene, object: ObjectModel) => Promise<void>];

/** The writers of files are loaded on demand. */
const writers = () => import("./files.js");

export const allExports: readonly Export[] = [
  ["GLB", async (_, object) => download(`${fileName(object.name)}-placed.glb`, (await writers()).glbBytes(object))],
  ["GLB of the scene", async (scene) => download("scene.glb", (await writers()).sceneBytes(scene))],
  [
    "JSON",
    async (scene, { name }) => {
      const of = scene.objects.length > 1 ? scene.name : name;
      download(`${fileName(of)}.json`, (await writers()).jsonText(scene));
    },
  ],
  [
    "BOP JSON",
    async (scene) => {
      if (isMetric(scene)) download("scene_gt.json", (await writers()).bopText(scene));
      else announce("BOP files are in millimetres: enter the known size of an object first.", "failed");
    },
  ],
  ["Copy matrix (column-major)", (_, object) => copyMatrix(object, "column")],
  ["Copy matrix (row-major)", (_, object) => copyMatrix(object, "row")],
  ["PLY", async (_, object) => download(`${fileName(object.name)}-placed.ply`, (await writers()).plyBytes(object))],
  ["Project", saveProject],
  ["Picture to share", (scene) => saveImage(fileName(scene.name))],
  [
    "Copy link",
    async ({ sample }) => {
      if (sample !== null) await copy(permalink(), "the link");
      else announce("Your own files cannot be linked. Save the project instead.", "failed");
    },
  ],
];

/** What can be saved of several scenes besides. */
export const listExport: Export = [
  "JSON of all scenes",
  async () => download("scenes.json", await (await writers()).allJsonText()),
];

/** What can be saved of a video besides. */
export const videoExport: Export = [
  "JSON of all frames",
  async (_, { name }) => download(`${fileName(name)}-frames.json`, (await writers()).videoText(name)),
];

async function copyMatrix(object: ObjectModel, order: "column" | "row"): Promise<void> {
  await copy((await writers()).matrixText(object, order), `the matrix (${order}-major)`);
}

/** Saves all scenes of this tab as one file. */
export async function saveProject(): Promise<void> {
  const name = list.peek().length > 1 ? "project" : (scene.peek()?.name ?? "");
  download(`${fileName(name)}.sim3align.zip`, await (await import("../session/project.js")).projectFile());
}

/** Saves the 3D view, in the size that is usual for links, or, without one, the image view. */
async function saveImage(name: string): Promise<void> {
  const state = space.peek();
  const image = state.kind === "ready" ? await state.view.picture(1200, 630) : await imageSnapshot(page);
  if (image === null) announce("There is no image yet.", "failed");
  else download(`${name}.png`, image);
}

/** Types of files by their extensions. */
const types: Readonly<Record<string, string>> = {
  glb: "model/gltf-binary",
  json: "application/json",
  png: "image/png",
  zip: "application/zip",
};

function download(name: string, content: string | Uint8Array | Blob): void {
  const type = types[extension(name)] ?? "application/octet-stream";
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

export async function copy(text: string, what: string): Promise<void> {
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
