/** `sim3align evaluate`: computes the metrics of transforms on cases. */

import { Command } from "commander";
import { frameNames, readCaseFolder, readFrames } from "../case-folder.js";
import type { KnownPose } from "../conventions/pose-file.js";
import { failure } from "../error.js";
import {
  type Aligner,
  type AlignInput,
  type Evaluation,
  OPTIONS,
  type OptionRow,
  type Sim3AlignError,
} from "../index.js";
import { isAboutOptions } from "./align-case.js";
import type { Done } from "./batch.js";
import { addBatchFlags, type BatchFlags, batchHelp } from "./batch-flags.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  statusHelp,
} from "./case-options.js";
import { caseKind, type FolderToDo, foldersToDo } from "./folders.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { evaluationJson, type Failure, failureOf, failureText } from "./outcome.js";
import { Output } from "./output.js";
import { EvaluationSummary, evaluationDetails } from "./report.js";
import { runBatch } from "./run-batch.js";
import type { Style } from "./style.js";
import { readTransform, transformFileHelp } from "./transform-file.js";
import { UsageError } from "./usage-error.js";

interface EvaluateFlags extends CaseFlags, BatchFlags, Readonly<Record<string, unknown>> {
  transform: string;
}

// The true pose and the symmetry come from the case.
const rows: readonly OptionRow[] = OPTIONS.evaluate.filter(({ name }) => name !== "truth" && name !== "symmetry");

const help = `${caseFolderHelp}
${conventionsHelp}
${transformFileHelp}

Output
  A row per case, or per frame of a case with frames that have a mask; a single case in detail. --json writes
  { "<case>": { metrics, errors, layout, warnings, diagnostics } }, or { frames: { "<frame>": the same } }.
${batchHelp(caseKind)}

Examples
  sim3align evaluate cases/mug --transform results.json
  sim3align evaluate 'cases/**' --transform results.jsonl --csv scores.csv
  sim3align evaluate views/mug --transform views.json
  sim3align evaluate cases/mug --transform gt --json scores.json
${statusHelp}`;

/** The command. */
export function evaluateCommand(): Command {
  const command = addBatchFlags(new Command("evaluate"), caseKind)
    .summary("compute the metrics of transforms")
    .description("Computes all metrics of a transform for each case and, if the case has gt.json, its errors.")
    .option("--transform <file|gt>", 'transform file, or "gt" for the true poses of the cases', "gt");
  addOptionFlags(addCaseOptions(command), rows);
  return command.addHelpText("after", help).action(run);
}

async function run(args: string[], flags: EvaluateFlags): Promise<void> {
  const cases = await foldersToDo(caseKind, args, flags.list);
  const output = new Output(flags);
  const summary = new EvaluationSummary(cases, output.style);
  await runBatch(cases, flags, output, {
    async run(aligner, key, live): Promise<Done> {
      const results = await evaluateCase(aligner, key, flags);
      const [, first] = results[0] ?? [];
      const isWhole = results.length === 1 && first !== undefined && results[0]?.[0] === undefined;
      const entry = isWhole
        ? evaluationJson(first)
        : { frames: Object.fromEntries(results.map(([frame, result]) => [frame, evaluationJson(result)])) };
      const named = results.map(
        ([frame, result]) => [frame === undefined ? key.name : `${key.name}/${frame}`, result] as const,
      );
      const failures = named.flatMap(([name, result]) =>
        "error" in result ? [failed(name, result, output.style)] : [],
      );
      if (live === undefined)
        return { key, entry, rows: named.flatMap((each) => summary.lines(...each)), remarks: failures };
      const details = named.flatMap(([name, result]) =>
        "error" in result ? [failed(name, result, output.style)] : evaluationDetails(name, result, output.style),
      );
      return { key, entry, rows: [], remarks: details };
    },
  });
}

const failed = (name: string, failure: Failure, style: Style) =>
  style.red("failed ") + failureText({ ...failure, name });

/** The metrics of a case, or of each of its frames with a mask, by name. Only errors that concern all cases are thrown. */
async function evaluateCase(
  aligner: Aligner,
  { name, folder }: FolderToDo,
  flags: EvaluateFlags,
): Promise<[frame: string | undefined, result: Evaluation | Failure][]> {
  const given = givenOptions(flags, rows);
  const evaluate = async (input: AlignInput, truth: KnownPose | null, frame?: string) => {
    if (flags.transform === "gt" && truth === null) throw noTruth(frame === undefined ? folder : `${folder}/${frame}`);
    const matrix =
      flags.transform === "gt"
        ? truth?.transform.matrix
        : await readTransform("transform", flags.transform, name, frame);
    const against = truth === null ? {} : { truth: truth.transform, symmetry: truth.symmetry };
    return aligner.evaluate(input, { matrix: matrix ?? [] }, { ...given, ...against });
  };
  const attempt = async (files: Readonly<Record<string, string>>, run: () => Promise<Evaluation>) => {
    try {
      return await run();
    } catch (error) {
      if (error instanceof UsageError) throw error;
      if (isAboutOptions(error)) throw new UsageError(error.message);
      return failureOf(name, error, files);
    }
  };
  try {
    if ((await frameNames(folder)).length === 0) {
      const { input, truth, files } = await readCaseFolder(folder, caseSettings(flags));
      return [[undefined, await attempt(files, () => evaluate(input, truth))]];
    }
    const { mesh, frames } = await readFrames(folder, caseSettings(flags));
    const results: [string, Evaluation | Failure][] = [];
    for (const { name: frame, input, files, truth } of frames) {
      const { cameraToWorld, ...view } = input;
      if (view.mask === undefined) continue;
      const whole = { ...view, mesh } as AlignInput;
      results.push([frame, await attempt(files, () => evaluate(whole, truth, frame))]);
    }
    return results;
  } catch (error) {
    if (error instanceof UsageError) throw error;
    return [[undefined, failureOf(name, error)]];
  }
}

function noTruth(folder: string): Sim3AlignError {
  const remedy = "Pass --transform FILE.";
  return failure("FILE_NOT_FOUND", "transform", `no true pose in ${folder}`, "gt.json with a pose", remedy);
}
