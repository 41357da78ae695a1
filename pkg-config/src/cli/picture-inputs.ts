/** Reads the inputs of cases again, for pictures. */
import { readFrames } from "../case-folder.js";
import type { AlignInput } from "../index.js";
import { type CaseFlags, caseSettings } from "./case-options.js";
import type { CaseToDo } from "./cases.js";
import { type Pictures, shownIn } from "./pictures.js";

/**
 * Draws the poses in the entry of a case. What cannot be drawn is said, and changes no result.
 * @param isResumed whether pictures may be there already
 */
export async function drawEntry(
  pictures: Pictures,
  { name, folder, read }: CaseToDo,
  entry: object,
  flags: CaseFlags,
  isResumed = false,
): Promise<void> {
  if (!pictures.isWanted || "error" in entry) return;
  const shown = shownIn(name, entry);
  if (isResumed && shown.every((each) => pictures.has(each.name))) return;
  try {
    if (!("frames" in entry) || folder === undefined) {
      const { input } = await read();
      for (const each of shown) await pictures.draw({ ...each, input });
      return;
    }
    const { mesh, frames } = await readFrames(folder, caseSettings(flags));
    for (const { name: frame, input } of frames) {
      const { cameraToWorld, ...view } = input;
      const own = shown.find((each) => each.name === `${name}/${frame}`);
      if (own !== undefined && view.mask !== undefined)
        await pictures.draw({ ...own, input: { ...view, mesh } as AlignInput });
    }
  } catch (error) {
    console.error(`no pictures of ${name}: ${(error as Error).message}`);
  }
}
