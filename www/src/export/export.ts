/** Copies and saves results. */
import { extension } from "../input/files.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { permalink } from "../state/permalink.js";
import type { Scene } from "../state/scene.js";
import { isMetric } from "../state/scene.js";
import { imageSnapshot } from "../views/image-view.js";

const { announce, list, scene, space, video } = page;

/** A way to save or copy the object or the whole scene. */
export interface Export {
  /** The title of its button. */
  title: string;
  /** What it is for. */
  about: string;
  act(scene: Scene, object: ObjectModel): Promise<void>;
}

/** The writers of files are loaded on demand. */
const writers = () => import("./files.js");
const simulators = () => import("./simulators.js");

const results: Export = {
  ...{ title: "JSON", about: "Poses, sizes and confidences; the command line reads it" },
  async act(scene, { name }) {
    download(`${fileName(scene.objects.length > 1 ? scene.name : name)}.json`, (await writers()).jsonText(scene));
  },
};

const picture: Export = {
  ...{ title: "Picture", about: "The 3D view, 1200 × 630, to share" },
  act: (scene) => saveImage(fileName(scene.name)),
};

/** What can be saved of several scenes besides. */
const listResults: Export = {
  ...{ title: "JSON of all scenes", about: "The results of every scene of the list" },
  act: async () => download("scenes.json", await (await writers()).allJsonText()),
};

/** What can be saved of a video besides. */
const videoResults: readonly Export[] = [
  {
    ...{ title: "JSON of all frames", about: "The poses of the video by frame" },
    act: async (_, { name }) => download(`${fileName(name)}-frames.json`, (await writers()).videoText(name)),
  },
  {
    ...{ title: "Animated GLB", about: "The object as it moves, and the camera" },
    act: async (scene, one) => download(`${fileName(one.name)}-frames.glb`, (await writers()).videoBytes(scene, one)),
  },
];

/** What is in sight. */
export const firstExports = (): Export[] => [
  ...(video.value === null ? [] : videoResults),
  ...(list.value.length > 1 ? [listResults] : []),
  ...[results, picture],
];

/** All others, by what they are. */
export const exportGroups: readonly (readonly [title: string, exports: readonly Export[]])[] = [
  [
    "Meshes",
    [
      {
        ...{ title: "GLB", about: "The object at its size, for viewers and engines" },
        act: async (_, one) => download(`${fileName(one.name)}-placed.glb`, (await writers()).glbBytes(one)),
      },
      {
        ...{ title: "GLB of the scene", about: "All objects, y up, on the ground" },
        act: async (scene) => download("scene.glb", (await writers()).sceneBytes(scene)),
      },
      {
        ...{ title: "PLY", about: "The object in the camera's frame, for point tools" },
        act: async (_, one) => download(`${fileName(one.name)}-placed.ply`, (await writers()).plyBytes(one)),
      },
    ],
  ],
  [
    "Poses",
    [
      {
        ...{ title: "BOP JSON", about: "scene_gt.json of pose benchmarks, millimetres" },
        async act(scene) {
          if (isMetric(scene)) download("scene_gt.json", (await writers()).bopText(scene));
          else announce("BOP files are in millimetres: enter the known size of an object first.", "failed");
        },
      },
      {
        ...{ title: "Copy matrix (column-major)", about: "three.js, OpenGL, Unity" },
        act: (_, object) => copyMatrix(object, "column"),
      },
      {
        ...{ title: "Copy matrix (row-major)", about: "NumPy, ROS, Blender" },
        act: (_, object) => copyMatrix(object, "row"),
      },
    ],
  ],
  [
    "Simulators",
    [
      {
        ...{ title: "MJCF", about: "MuJoCo: rigid bodies with mass, a zip" },
        act: async (scene) => download("mjcf.zip", await (await simulators()).mjcfZip(scene)),
      },
      {
        ...{ title: "URDF", about: "PyBullet and ROS, a zip" },
        act: async (scene) => download("urdf.zip", await (await simulators()).urdfZip(scene)),
      },
      {
        ...{ title: "USD", about: "Isaac Sim and Omniverse" },
        act: async (scene) => download("scene.usda", await (await simulators()).usdText(scene)),
      },
    ],
  ],
  [
    "Masks and files",
    [
      {
        ...{ title: "COCO JSON", about: "The masks as annotations, with corrections" },
        act: async (scene) => download("masks.json", (await simulators()).cocoText(scene)),
      },
      {
        ...{ title: "Masks as PNG", about: "One picture an object, a zip" },
        act: async (scene) => download("masks.zip", await (await simulators()).maskZip(scene)),
      },
      { title: "Project", about: "All scenes with files and decisions, to go on elsewhere", act: saveProject },
      {
        ...{ title: "Copy link", about: "This sample with its options" },
        act: () => copy(permalink(), "the link"),
      },
    ],
  ],
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
