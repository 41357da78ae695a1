/** Scenes for simulators, and the masks of a scene. */
import { zipSync } from "fflate";
import { toCocoRle } from "sim3align/input/coco-rle";
import { toMjcf } from "sim3align/simulators/mjcf";
import { simulatorScene } from "sim3align/simulators/scene";
import { toUrdf } from "sim3align/simulators/urdf";
import { toUsd } from "sim3align/simulators/usd";
import { maskFile } from "../masking/mask-file.js";
import { boxOf } from "../pictures/box.js";
import { keyOf } from "../session/results.js";
import { page } from "../state/page.js";
import { isMetric, type Scene } from "../state/scene.js";

/** The placed objects as rigid bodies, at rest on the ground where that is known. */
async function simulated(scene: Scene) {
  if (!isMetric(scene)) throw new Error("Simulators need metres: enter the known size of an object first.");
  const placed = scene.objects.filter(({ isPlaced }) => isPlaced);
  const { width, height, camera } = scene;
  const objects = placed.map((object) => {
    const { restsOn = null } = object.alignment.peek()?.contact ?? {};
    const below =
      typeof restsOn === "number" ? placed.indexOf(scene.objects[restsOn] as (typeof placed)[number]) : restsOn;
    return {
      name: keyOf(scene, object),
      mesh: object.mesh,
      transform: object.pose.peek().transform,
      restsOn: below === -1 ? null : below,
    };
  });
  page.announce("Preparing bodies …", "working");
  return simulatorScene(objects, { support: page.support.peek(), camera: { ...camera, width, height } });
}

const zipped = (texts: Record<string, string>): Uint8Array =>
  zipSync(Object.fromEntries(Object.entries(texts).map(([name, text]) => [name, new TextEncoder().encode(text)])));

export const mjcfZip = async (scene: Scene): Promise<Uint8Array> => zipped(toMjcf(await simulated(scene)));
export const urdfZip = async (scene: Scene): Promise<Uint8Array> => zipped(toUrdf(await simulated(scene)));
export const usdText = async (scene: Scene): Promise<string> => toUsd(await simulated(scene));

/** The masks as a COCO file of one image, as they are now. */
export function cocoText(scene: Scene): string {
  const { width, height } = scene;
  const file_name = page.inputs.peek().photo?.path ?? page.inputs.peek().depth?.path ?? scene.name;
  const annotations = scene.objects.map(({ mask }, i) => {
    const box = boxOf(mask, width);
    const bbox = box === null ? [0, 0, 0, 0] : [box.left, box.top, box.right - box.left, box.bottom - box.top];
    const area = mask.reduce((sum, value) => sum + (value === 0 ? 0 : 1), 0);
    const segmentation = toCocoRle({ data: mask, width, height });
    return { id: i + 1, image_id: 1, category_id: i + 1, segmentation, area, bbox, iscrowd: 0 };
  });
  const categories = scene.objects.map((object, i) => ({ id: i + 1, name: keyOf(scene, object) }));
  return JSON.stringify({ images: [{ id: 1, file_name, width, height }], annotations, categories }, null, 1);
}

/** The masks as pictures of black and white. */
export async function maskZip(scene: Scene): Promise<Uint8Array> {
  const files = await Promise.all(
    scene.objects.map((object) => maskFile(object.mask, scene, scene, keyOf(scene, object).replaceAll("/", "-"))),
  );
  return zipSync(Object.fromEntries(await Promise.all(files.map(async ({ path, bytes }) => [path, await bytes()]))), {
    level: 0,
  });
}
