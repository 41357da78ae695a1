/**
 * The dataset of tests/fixtures/bop: three objects (an uneven one, a brick and a can) in four images, each of which hides a
 * part of another.
 */
import { cpSync } from "node:fs";
import { join } from "node:path";
import { readMask } from "sim3align/formats";
import { repository } from "./environment.js";
import { cocoRle, fixture } from "./files.js";

/** Writes the dataset; its name is that of the folder. */
export function writeBop(folder: string): void {
  const dataset = join(repository, "tests", "fixtures", "bop", "tudl");
  cpSync(dataset, folder, { recursive: true });
  cpSync(join(dataset, "models"), join(folder, "models_eval"), { recursive: true });
}

/** The segmentation of a detection: a mask of the dataset, as `000001/mask_visib/000007_000003.png`. */
export async function segmentation(path: string) {
  const { data, width, height } = await readMask(fixture(`bop/tudl/test/${path}`));
  return cocoRle(data, width, height);
}
