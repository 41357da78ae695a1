/** Reads the inputs of cases again, for pictures. */
import { readFrames } from "../case-folder.js";
import type { AlignInput } from "../index.js";
import { type CaseFlags, caseSettings } from "./case-options.js";
import type { CaseToDo } from "./cases.js";
import { type Pictures, shownIn } from "./pictures.js";

/**
 * Draws the poses in an entry. What cannot be drawn is said, and changes no result.
 * @param isResumed whether pictures may be there already
 * @param inputsOf reads what the poses were found in, by the names that {@link shownIn} gives them
 */
export async function drawEntry(
  pictures: Pictures,
  name: string,
  entry: object,
  isResumed: boolean,
  inputsOf: () => Promise<ReadonlyMap<string, AlignInput>>,
): Promise<void> {
  if (!pictures.isWanted || "error" in entry) return;
  const shown = shownIn(name, entry);
  if (isResumed && shown.every((each) => pictures.has(each.name))) return;
  try {
    const inputs = await inputsOf();
    for (const each of shown) await pictures.draw({ ...each, input: inputs.get(each.name) });
  } catch (error) {
    console.error(`no pictures of ${name}: ${(error as Error).message}`);
  }
}

/** What the poses of a case were found in. */
export async function inputsOfCase(
  { name, folder, read }: CaseToDo,
  entry: object,
  flags: CaseFlags,
): Promise<Map<string, AlignInput>> {
  if (!("frames" in entry) || folder === undefined) return new Map([[name, (await read()).input]]);
  const { mesh, frames } = await readFrames(folder, caseSettings(flags));
  const inputs = new Map<string, AlignInput>();
  for (const { name: frame, input } of frames) {
    const { cameraToWorld, ...view } = input;
    if (view.mask !== undefined) inputs.set(`${name}/${frame}`, { ...view, mesh } as AlignInput);
  }
  return inputs;
}
