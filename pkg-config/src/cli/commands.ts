/** The table of commands. Parsing, help, and the lists of inputs and outputs of a run follow from it. */
import { OPTIONS } from "../index.js";
import { formatsText } from "../input/formats.js";
import { Sim3AlignError } from "../values/error.js";
import { alignJob, paper, precise, shared } from "./align.js";
import { type Job, runBatch } from "./batch.js";
import { bopJob, bopOptions, resultsFile } from "./bop.js";
import { checkJob } from "./check.js";
import { evaluateJob, evaluateOptions } from "./evaluate.js";
import { isFile, isOrdinary, UsageError } from "./files.js";
import {
  batchFlags,
  caseFlags,
  checkInputs,
  checkNeeds,
  type Flag,
  type FlagList,
  type Flags,
  filesOf,
  listFlag,
  ofCase,
  pictureFlags,
  reads,
  recordFlags,
  sceneFileFlags,
  settingsOf,
  writes,
} from "./flags.js";
import { alignHelp, bopHelp, checkHelp, evaluateHelp, sceneHelp, serveHelp, trackHelp } from "./help.js";
import { inFlags, optionFlags } from "./option-flags.js";
import { makeFolder } from "./output-file.js";
import { camera, jsonObject } from "./parse.js";
import { pictureFiles } from "./pictures.js";
import type { CaseKey } from "./record.js";
import { lockOf } from "./record-lock.js";
import { isResults } from "./result-files.js";
import { isExport, type OutputName, RunFiles } from "./run-files.js";
import { sceneJob } from "./scene.js";
import { serve } from "./serve.js";
import { trackJob } from "./track.js";

/** A command. */
export interface CommandRow {
  name: string;
  summary: string;
  description: string;
  /** The name and the meaning of its arguments. */
  argument?: readonly [name: string, meaning: string];
  flags: FlagList;
  /** The text after the flags in the help. */
  help: string;
  /** Outputs that no flag names. */
  writes?(args: readonly string[], flags: Flags): OutputName[];
  /** Runs a command that is no batch. */
  run?(flags: Flags): Promise<boolean>;
  /** Finds the cases of a batch. */
  prepare?(args: readonly string[], flags: Flags, files: RunFiles): Promise<Job<CaseKey>>;
}

/** A function that finds the cases of a command. The type of the cases is its own matter. */
type Prepare<T extends CaseKey> = (args: readonly string[], flags: Flags, files: RunFiles) => Promise<Job<T>>;
const batch = <T extends CaseKey>(prepare: Prepare<T>) => prepare as unknown as NonNullable<CommandRow["prepare"]>;

const folders = (noun: string) => [`[${noun}...]`, `${noun} folders, or patterns such as '${noun}s/*'`] as const;

export const commands: readonly CommandRow[] = [
  {
    name: "align",
    summary: "align the mesh of each case to its depth map",
    description: "Aligns the mesh of each case to its masked depth map.",
    argument: folders("case"),
    flags: [
      ...batchFlags("case"),
      ["--depth <file>", `depth map (${formatsText("depth")}), instead of a case folder`, ofCase],
      ["--mask <file>", `mask (${formatsText("mask")})`, ofCase],
      ["--mesh <file>", `mesh (${formatsText("mesh")})`, ofCase],
      [
        "--camera <file|fx,fy,cx,cy|fov:deg>",
        "camera: a file, intrinsics or a vertical field of view",
        { parse: camera, ...ofCase },
      ],
      [
        "--image <file>",
        `photo (${formatsText("photo")}) with the field of view of the depth map, also without the flag`,
        ofCase,
      ],
      [
        "--preset <name>",
        "method (default precise); --help paper shows the options of paper",
        { choices: ["precise", "paper"] },
      ],
      ...pictureFlags,
      ...caseFlags,
      ...optionFlags(shared),
      ["--options <json>", "further options of align() as JSON; flags take precedence", { parse: jsonObject }],
      "Options of --preset precise:",
      ...optionFlags(precise),
      "Options of --preset paper:",
      ...optionFlags(paper).map(([flag, meaning, facts]): Flag => [flag, meaning, { ...facts, topic: "paper" }]),
    ],
    help: alignHelp,
    prepare: batch(alignJob),
  },
  {
    name: "track",
    summary: "track the mesh of each video through its frames",
    description: "Tracks the object of a mesh through the frames of each video.",
    argument: folders("video"),
    flags: [...batchFlags("video"), ...caseFlags, ...optionFlags(OPTIONS.track)],
    help: trackHelp,
    prepare: batch(trackJob),
  },
  {
    name: "evaluate",
    summary: "compute the metrics of transforms",
    description: "Computes all metrics of a transform for each case and, if the case has gt.json, its errors.",
    argument: folders("case"),
    flags: [
      ...batchFlags("case"),
      [
        "--transform <file|gt>",
        'transform file, or "gt" for the true poses of the cases',
        { default: "gt", ...reads, words: ["gt"], isReplaceable: true },
      ],
      ...caseFlags,
      ...optionFlags(evaluateOptions),
    ],
    help: evaluateHelp,
    prepare: batch(evaluateJob),
  },
  {
    name: "check",
    summary: "read cases without aligning them, and name what would fail or be doubted",
    description: "Reads each case without aligning it, and names what would fail or be doubted.",
    argument: folders("case"),
    flags: [
      listFlag("case"),
      ["--json <file>", 'write what was read as JSON; "-" is stdout', { ...writes, isOwn: isResults }],
      ...caseFlags,
    ],
    help: checkHelp,
    prepare: batch(checkJob),
  },
  {
    name: "scene",
    summary: "align all objects of each scene, and what they stand on",
    description: "Aligns the objects of each scene together: one depth map, a mask and a mesh per object.",
    argument: folders("scene"),
    flags: [
      ...batchFlags("scene"),
      ...sceneFileFlags,
      [
        "--support <auto|none|file>",
        'what objects stand on: found, nothing, or a JSON file { "normal", "d" }',
        { ...reads, words: ["auto", "none"] },
      ],
      ["--models <folder>", "the models of a BOP scene", reads],
      ["--sam3d", "the folders are outputs of SAM 3D Objects"],
      ...pictureFlags,
      ...caseFlags,
      "Options of alignScene, for every object:",
      ...optionFlags(OPTIONS.alignScene),
    ],
    help: sceneHelp,
    prepare: batch(sceneJob),
  },
  {
    name: "serve",
    summary: "align what lines of JSON on standard input name, and write a line for each",
    description:
      "Aligns what lines of JSON on standard input name, and writes a line of JSON for each, until the input ends.",
    flags: recordFlags("request").filter(([flag]) => flag.startsWith("--workers")),
    help: serveHelp,
    run: serve,
  },
  {
    name: "bop",
    summary: "align the targets of a BOP dataset",
    description:
      "Aligns each target of a BOP dataset, at its known size, and writes the results file of the leaderboard.",
    argument: ["<dataset>", "the folder of the dataset"],
    flags: [
      ...recordFlags("pose"),
      ["--split <name>", "the folder of the split, such as test or test_primesense", { isRequired: true }],
      [
        "--masks <gt|file>",
        "masks of the dataset, or a file with 2D detections",
        { default: "gt", ...reads, words: ["gt"] },
      ],
      ["--models <folder>", "the models to align", reads],
      ["--targets <file>", "what to find, as in test_targets_bop19.json", reads],
      [
        "--method <name>",
        "the first part of the name of the results file",
        { default: "sim3align", isIndifferent: true },
      ],
      ["--suffix <name>", "the last part of the name of the results file", { isIndifferent: true }],
      ["--no-image", "do not read the photos: align by shape alone"],
      ...pictureFlags,
      ...optionFlags(bopOptions),
      ["--options <json>", "further options of align() as JSON; flags take precedence", { parse: jsonObject }],
    ],
    help: bopHelp,
    writes: resultsFile,
    prepare: batch(bopJob),
  },
];

/**
 * Runs a command: checks its inputs and outputs, finds its cases, and works on them.
 * @returns whether everything succeeded that was asked for
 * @throws {@link UsageError} before anything is written; {@link OutputError}
 */
export async function runCommand(command: CommandRow, args: readonly string[], flags: Flags): Promise<boolean> {
  const { name, flags: list, prepare } = command;
  checkNeeds(list, flags);
  checkInputs(list, flags);
  if (prepare === undefined) return command.run?.(flags) ?? true;
  const [argument = ""] = command.argument ?? [];
  const named = args.flatMap((path) => (isFile(path) ? [{ flag: argument, path }] : []));
  const read = filesOf(list, flags, "reads").map((file) => ({ ...file, isDeep: true }));
  const files = new RunFiles([...named, ...read]);
  const { jsonl = "-" } = flags;
  const outputs = [
    ...filesOf(list, flags, "writes"),
    ...(command.writes?.(args, flags) ?? []),
    ...(isOrdinary(jsonl) ? [lockOf(jsonl)] : []),
  ];
  // An input, which is not known yet, is named as such, rather than as a file of another program.
  files.check(outputs.map(({ isOwn, ...output }) => (isOwn === isExport ? output : { ...output, isOwn })));
  const job = await prepare(args, flags, files).catch((error) => {
    // What the command line names is wrong, before any case.
    throw error instanceof Sim3AlignError ? new UsageError(error.message, { cause: error }) : error;
  });
  const inputs = [...new Set(job.folders)].map((path) => ({
    flag: argument,
    path,
    isFolder: true,
    isDeep: job.isDeep,
  }));
  files.add(inputs);
  files.check([...outputs, ...pictureFiles(flags, job.tasks)]);
  for (const { flag, path, isFolder } of outputs) if (isFolder) makeFolder(flag, path);
  try {
    return await runBatch(job, flags, files, (pathOf) => ({ command: name, options: settingsOf(list, flags, pathOf) }));
  } catch (error) {
    throw error instanceof UsageError ? new UsageError(inFlags(error.message, list), { cause: error }) : error;
  }
}
