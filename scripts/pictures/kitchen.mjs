/** The first sample of the page: what Blender renders of a kitchen table, in files that are small enough to be downloaded. */
import { copyFileSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { digest } from "../lib/cache.mjs";
import { at } from "../lib/paths.mjs";
import { pythonOf } from "../lib/python.mjs";
import { run } from "../lib/run.mjs";
import { step } from "../lib/step.mjs";

export const kitchenDir = at("www", "samples", "kitchen");

/** Its objects. */
export const kitchenObjects = ["duck", "mug", "box"];

const requirements = at("scripts", "pictures", "kitchen", "requirements.txt");

/** Renders the scene, which takes some minutes, and writes the sample. @param {string} program the Python for Blender */
export async function renderKitchen(program) {
  const folder = at("target", "pictures", "python");
  const install = () => pythonOf(folder, digest([requirements]), ["--requirement", requirements], program);
  const python = await step("Blender", install);
  const rendered = at("target", "pictures", "kitchen");
  const env = { PYTHONPATH: at("scripts", "pictures"), PYTHONDONTWRITEBYTECODE: "1" };
  await step("kitchen", () => run(python, ["-m", "kitchen", rendered], { env }));

  mkdirSync(kitchenDir, { recursive: true });
  for (const name of ["camera.json", "depth.png", "rgb.webp"])
    copyFileSync(join(rendered, name), join(kitchenDir, name));
  const gltfpack = createRequire(import.meta.url).resolve("gltfpack/cli.js");
  for (const name of kitchenObjects) {
    const [from, to] = [join(rendered, "objects", name), join(kitchenDir, "objects", name)];
    mkdirSync(to, { recursive: true });
    for (const file of ["mask.png", "gt.json"]) copyFileSync(join(from, file), join(to, file));
    await run(process.execPath, [
      ...[gltfpack, "-i", join(from, "mesh.glb"), "-o", join(to, "mesh.glb")],
      ...["-vp", "12", "-vt", "10", "-c", "-kn"],
    ]);
  }
}
