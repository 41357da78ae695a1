/** `sim3align evaluate`: computes the metrics of transforms on cases. */

import { Command } from "commander";
import { frameNames, inputOfFrame, readCaseFolder, readFrames } from "../case-folder.js";
import type { KnownPose } from "../conventions/pose-file.js";
import {
  type Aligner,
  type AlignInput,
  type Evaluation,
  OPTIONS,
  type OptionRow,
  type Sim3AlignError,
} from "../index.js";
import { failure } from "../values/error.js";
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
import { Lengths } from "./lengths.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { evaluationJson, type Failure, failedLine, failureOf } from "./outcome.js";
import { Output } from "./output.js";
import { evaluationDetails, evaluationTable } from "./report.js";
import { runBatch } from "./run-batch.js";
import { readTransform, transformFileHelp } from "./transform-file.js";

interface EvaluateFlags extends CaseFlags, BatchFlags, Readonly<Record<string, unknown>> {
  transform: string;
}

// The true pose and the symmetry come from the case.
const rows: readonly OptionRow[] = OPTIONS.evaluate.filter(({ name }) => name !== "truth" && name !== "symmetry");

const help = `${caseFolderHelp}
${conventionsHelp}

Depth of models
  Metrics need a camera and depth without an unknown shift: --depth-kind is metric, or scale-invariant (times an unknown
  factor). Transforms of scale-invariant depth are in its unit, and lengths are printed as "units"; columns in metres and
  millimetres are empty.
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
  const { style } = output;
  const names = cases.map(({ name }) => name);
  const lengths = new Lengths((flags.depthKind ?? "metric") === "metric");
  const row = evaluationTable(names, lengths, style);
  await runBatch(cases, flags, output, {
    async run(aligner, key, live): Promise<Done> {
      const results = await evaluateCase(aligner, key, flags);
      const json = results.map(({ result }) => evaluationJson(result, lengths));
      const isWhole = results.length === 1 && results[0]?.frame === undefined;
      const frames = Object.fromEntries(results.map(({ frame }, i) => [frame, json[i]]));
      const rows: string[] = [];
      const remarks: string[] = [];
      for (const { frame, result } of results) {
        const name = frame === undefined ? key.name : `${key.name}/${frame}`;
        if (live === undefined) rows.push(...row(name, result));
        if ("error" in result) remarks.push(failedLine({ ...result, name }, style));
        else if (live !== undefined) remarks.push(...evaluationDetails(name, result, lengths, style));
      }
      return { key, entry: isWhole ? (json[0] as object) : { frames }, rows, remarks };
    },
  });
}

/** The result of a case, or of one of its frames. */
interface Evaluated {
  frame?: string;
  result: Evaluation | Failure;
}

/** The metrics of a case, or of each of its frames with a mask. Only errors that concern all cases are thrown. */
async function evaluateCase(
  aligner: Aligner,
  { name, folder }: FolderToDo,
  flags: EvaluateFlags,
): Promise<Evaluated[]> {
  const given = givenOptions(flags, rows);
  type Known = { truth: KnownPose | null; files: Readonly<Record<string, string>> };
  const evaluate = async (input: AlignInput, { truth, files }: Known, frame?: string) => {
    try {
      if (flags.transform === "gt" && truth === null)
        throw noTruth(frame === undefined ? folder : `${folder}/${frame}`);
      const matrix =
        flags.transform === "gt"
          ? truth?.transform.matrix
          : await readTransform("transform", flags.transform, name, frame);
      const against = truth === null ? {} : { truth: truth.transform, symmetry: truth.symmetry };
      return await aligner.evaluate(input, { matrix: matrix ?? [] }, { ...given, ...against });
    } catch (error) {
      return failureOf(name, error, files);
    }
  };
  try {
    if ((await frameNames(folder)).length === 0) {
      const read = await readCaseFolder(folder, caseSettings(flags));
      return [{ result: await evaluate(read.input, read) }];
    }
    const { mesh, frames } = await readFrames(folder, caseSettings(flags));
    const results: Evaluated[] = [];
    for (const read of frames) {
      const input = inputOfFrame(read, mesh);
      if (input !== undefined) results.push({ frame: read.name, result: await evaluate(input, read, read.name) });
    }
    return results;
  } catch (error) {
    return [{ result: failureOf(name, error) }];
  }
}

function noTruth(folder: string): Sim3AlignError {
  const found = `no true pose in ${folder}`;
  return failure("FILE_NOT_FOUND", "transform", found, "gt.json with a pose", "Pass --transform FILE.");
}
