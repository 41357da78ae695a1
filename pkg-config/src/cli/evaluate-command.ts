/** `sim3align evaluate`: computes the metrics of a transform on a case. */
import { Command } from "commander";
import { readCaseFolder } from "../case-folder.js";
import { createAligner, type Evaluation, OPTIONS, type OptionRow, Sim3AlignError } from "../index.js";
import {
  addCaseOptions,
  type CaseFlags,
  caseFolderHelp,
  caseSettings,
  conventionsHelp,
  statusHelp,
} from "./case-options.js";
import { addOptionFlags, givenOptions } from "./option-flags.js";
import { evaluationJson, type Failure, failure, failureText } from "./outcome.js";
import { Output } from "./output.js";
import { evaluationDetails } from "./report.js";
import { readTransform, transformFileHelp } from "./transform-file.js";

interface EvaluateFlags extends CaseFlags, Readonly<Record<string, unknown>> {
  transform: string;
  json?: string;
}

// The true pose and the symmetry come from the case.
const rows: readonly OptionRow[] = OPTIONS.evaluate.filter(({ name }) => name !== "truth" && name !== "symmetry");

const help = `${caseFolderHelp}
${conventionsHelp}
${transformFileHelp}

Examples
  sim3align evaluate cases/mug --transform results.json
  sim3align evaluate cases/mug --transform gt --json scores.json
${statusHelp}`;

/** The command. */
export function evaluateCommand(): Command {
  const command = new Command("evaluate")
    .summary("compute the metrics of a transform")
    .description("Computes all metrics of a transform and, if the case has gt.json, its errors.")
    .argument("<case>", "case folder")
    .option("--transform <file|gt>", 'transform file, or "gt" for the true pose of the case', "gt")
    .option("--json <file>", 'write the metrics as JSON; "-" is stdout');
  addOptionFlags(addCaseOptions(command), rows);
  return command.addHelpText("after", help).action(run);
}

async function run(folder: string, flags: EvaluateFlags): Promise<void> {
  const output = new Output(flags);
  const [name, result] = await evaluateCase(folder, flags);
  output.add(name, evaluationJson(result));
  output.end();
  if ("error" in result) {
    output.lines([output.style.red("failed ") + failureText(result)]);
    process.exitCode = 1;
  } else {
    output.lines(evaluationDetails(name, result, output.style));
  }
}

async function evaluateCase(folder: string, flags: EvaluateFlags): Promise<[name: string, Evaluation | Failure]> {
  let name = folder;
  let files: Readonly<Record<string, string>> = {};
  try {
    const { input, truth, ...known } = await readCaseFolder(folder, caseSettings(flags));
    ({ name, files } = known);
    if (flags.transform === "gt" && truth === null) throw noTruth(folder);
    const matrix =
      flags.transform === "gt" ? truth?.transform.matrix : await readTransform("transform", flags.transform, name);
    const aligner = await createAligner();
    const given = givenOptions(flags, rows);
    const against = truth === null ? {} : { truth: truth.transform, symmetry: truth.symmetry };
    return [name, await aligner.evaluate(input, { matrix: matrix ?? [] }, { ...given, ...against })];
  } catch (error) {
    return [name, failure(name, error, files)];
  }
}

function noTruth(folder: string): Sim3AlignError {
  return new Sim3AlignError({
    code: "FILE_NOT_FOUND",
    argument: "transform",
    found: `no true pose in ${folder}`,
    expected: "gt.json with a pose",
    remedy: "Pass --transform FILE.",
  });
}
