/** Aligns a case, with the options of the command line. */
import { type CaseOnDisk, frameNames, inputOfFrame, readFrames } from "../case-folder.js";
import type { KnownPose } from "../conventions/pose-file.js";
import {
  type Aligner,
  type AlignInput,
  type InputInfo,
  OPTIONS,
  type OptionRow,
  type OptionsOf,
  type PoseErrors,
  type Preset,
  type Progress,
  type Sim3,
  type ViewsOptions,
} from "../index.js";
import { withoutUndefined } from "../values/values.js";
import { type CaseFlags, caseSettings } from "./case-options.js";
import type { CaseToDo } from "./cases.js";
import { correctedInput } from "./corrected-input.js";
import { isMetric } from "./lengths.js";
import { givenOptions } from "./option-flags.js";
import { failureOf, type Outcome } from "./outcome.js";
import { readTransform } from "./transform-file.js";
import { UsageError } from "./usage-error.js";

/** The flags of the options. */
export interface AlignFlags extends CaseFlags, Readonly<Record<string, unknown>> {
  options?: Record<string, unknown>;
  preset?: Preset;
}

/** The options of both presets, and those of one. */
export const shared = OPTIONS.align.filter(({ name }) => OPTIONS.paper.some((row) => row.name === name));
const isShared = ({ name }: OptionRow) => shared.some((row) => row.name === name);
export const precise: readonly OptionRow[] = OPTIONS.align.filter((row) => !isShared(row));
export const paper: readonly OptionRow[] = OPTIONS.paper.filter((row) => !isShared(row));

/** Aligns a case. Only errors that concern all cases are thrown, as {@link UsageError}. */
export async function alignCase(
  aligner: Aligner,
  { name, folder, read }: CaseToDo,
  flags: AlignFlags,
  onProgress?: (progress: Progress) => void,
): Promise<Outcome> {
  let files: CaseOnDisk["files"] = {};
  try {
    if (folder !== undefined && (await frameNames(folder)).length > 0) {
      return await alignFrames(aligner, name, folder, flags, onProgress);
    }
    const { input, truth, ...read_ } = await read();
    files = read_.files;
    const options = await alignOptions(flags, name);
    const alignment = await aligner.align(input, withoutUndefined({ ...options, onProgress }));
    return { name, alignment, errors: await errorsOf(aligner, input, alignment, truth) };
  } catch (error) {
    return failureOf(name, error, files);
  }
}

/** Aligns a case of several views. Without the camera poses of all frames, those of some do not help. */
async function alignFrames(
  aligner: Aligner,
  name: string,
  folder: string,
  flags: AlignFlags,
  onProgress?: (progress: Progress) => void,
): Promise<Outcome> {
  const { mesh, frames } = await readFrames(folder, caseSettings(flags));
  const isKnown = frames.every(({ input }) => input.cameraToWorld !== undefined);
  const views = frames.map(({ input }) => (isKnown ? input : { ...input, cameraToWorld: undefined }));
  const { preset, ...options } = await alignOptions(flags, name);
  if (preset === "paper") throw new UsageError(`${name} has several frames, for which --preset paper has no method.`);
  const alignment = await aligner.alignViews(
    { mesh, views },
    withoutUndefined({ ...(options as ViewsOptions), onProgress }),
  );
  const errors = await Promise.all(
    frames.map(async (frame, k) => {
      const [pose, input] = [alignment.views[k], inputOfFrame(frame, mesh)];
      return pose === undefined || input === undefined ? null : errorsOf(aligner, input, pose, frame.truth);
    }),
  );
  return { name, views: alignment, frames: frames.map((frame) => frame.name), errors };
}

/** The errors of a pose relative to the true one, if that is known and the pose is metric. */
export async function errorsOf(
  aligner: Aligner,
  input: AlignInput,
  pose: Sim3 & InputInfo,
  truth: KnownPose | null | undefined,
): Promise<PoseErrors | null> {
  if (truth === null || truth === undefined || !isMetric(pose)) return null;
  const { transform, symmetry } = truth;
  const measured = await correctedInput(input, pose.depthCalibration);
  return (await aligner.evaluate(measured, pose, { truth: transform, symmetry, layout: false })).errors;
}

/** The options set by `--options` and by flags. */
async function alignOptions(flags: AlignFlags, name: string): Promise<OptionsOf<Preset, boolean>> {
  const given: Record<string, unknown> = {
    ...flags.options,
    ...givenOptions(flags, [...shared, ...precise, ...paper]),
    ...withoutUndefined({ preset: flags.preset }),
  };
  if (typeof given.initial === "string") given.initial = await readTransform("initial", given.initial, name);
  return given as unknown as OptionsOf<Preset, boolean>;
}
