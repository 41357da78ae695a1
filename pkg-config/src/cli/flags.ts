/** Flags of the table of commands, and the inputs and outputs that they name. */
import { type Command, Option } from "commander";
import type { ReadCaseOptions } from "../case-folder.js";
import type { CameraInput, Preset } from "../index.js";
import { depthCodeNames, depthKindNames } from "../input/formats.js";
import { SIMULATOR_DEFAULTS } from "../simulators/scene.js";
import type { DepthCode, DepthKind } from "../types/inputs.js";
import { isRecord } from "../values/kinds.js";
import { withoutUndefined } from "../values/validation.js";
import { statOf, UsageError } from "./files.js";
import { count, number, positive, workers } from "./parse.js";
import { isCsv, isResults } from "./result-files.js";
import { isExport, type NamedFile, type OutputName } from "./run-files.js";

/** Settings of a flag. */
export interface FlagSettings {
  parse?: (text: string) => unknown;
  choices?: readonly string[];
  default?: string;
  isRequired?: boolean;
  /** Whether its value names an input or an output; values in `words` name no file. */
  use?: "reads" | "writes";
  words?: readonly string[];
  /** Whether the file is read whole before it may be written. */
  isReplaceable?: boolean;
  /** See {@link OutputName}. */
  isOwn?: OutputName["isOwn"];
  holds?: OutputName["holds"];
  /** Whether it leaves results unchanged: names of cases, order and parallelism of the work. */
  isIndifferent?: boolean;
  /** Other flags, one of which it needs, and the name of these in the error. */
  needs?: { oneOf: readonly string[]; what: string };
  /** The argument of `--help` that shows it; other flags are then left out. */
  topic?: string;
}

/** A flag: its name with the name of its value, its meaning, and its settings. */
export type Flag = readonly [flag: string, meaning: string, facts?: FlagSettings];

export const reads = { use: "reads" } as const;
export const writes = { use: "writes" } as const;
/** Outputs that name the package, and that replace only each other. */
const exports = { ...writes, isOwn: isExport } as const;
/** A file of one case, which does not belong to the settings of a batch. */
export const ofCase = { use: "reads", isIndifferent: true } as const;

/** Flags, and titles in the help of the flags that follow. */
export type FlagList = readonly (Flag | string)[];

export const withoutTitles = (list: FlagList): Flag[] => list.filter((row) => typeof row !== "string");

type Texts =
  | ("list" | "json" | "jsonl" | "csv" | "report" | "overlay" | "glb" | "sceneGlb" | "mjcf" | "urdf" | "usd")
  | ("imageId" | "depth" | "mask" | "mesh" | "transform" | "support" | "models")
  | ("split" | "masks" | "targets" | "method" | "suffix");

/** Values of the flags of all commands. */
export interface Flags extends Readonly<Record<string, unknown>>, Readonly<Partial<Record<Texts, string>>> {
  readonly resume?: boolean;
  readonly workers?: number | "auto";
  readonly upright?: boolean;
  readonly depthScale?: number;
  readonly depthKind?: DepthKind;
  readonly depthCode?: DepthCode;
  readonly depthNear?: number;
  readonly depthFar?: number;
  readonly resizeMask?: "nearest";
  readonly maskIndex?: number;
  /** The photo, or whether to use that of a case folder. */
  readonly image?: string | boolean;
  readonly camera?: string | { value: CameraInput };
  readonly preset?: Preset;
  readonly options?: Record<string, unknown>;
  readonly sam3d?: boolean;
  readonly density?: number;
  readonly parts?: number;
  readonly rest?: boolean;
}

/** The record of a batch, and the number of workers. */
export const recordFlags = (noun: string): Flag[] => [
  ["--json <file>", 'write the results as JSON; "-" is stdout', { ...writes, isOwn: isResults }],
  [
    "--jsonl <file>",
    `write a line of JSON for each ${noun} when it is done; "-" is stdout`,
    // The record checks its lines.
    { ...writes, isOwn: () => true },
  ],
  [
    "--resume",
    `go on: skip the ${noun}s in the file of --jsonl whose files are unchanged, and append to it`,
    { needs: { oneOf: ["jsonl"], what: "--jsonl FILE, the record of what is done" }, isIndifferent: true },
  ],
  [
    "--workers <n|auto>",
    `${noun}s at a time (1 to 64; default auto: one less than the number of cores, 1 to 8)`,
    { parse: workers, isIndifferent: true },
  ],
];

export const listFlag = (noun: string): Flag => [
  "--list <file>",
  `a file with the path of a ${noun} folder per line; "-" is stdin`,
  { ...ofCase, words: ["-"] },
];

/** The flags of all commands that work on many folders. */
export const batchFlags = (noun: string): Flag[] => [
  listFlag(noun),
  ...recordFlags(noun),
  ["--csv <file>", 'write a table of comma-separated values; "-" is stdout', { ...writes, isOwn: isCsv }],
];

/** Pictures and posed meshes. */
export const pictureFlags: readonly Flag[] = [
  [
    "--report <folder>",
    "write a page with a table, pictures and a 3D view of each case",
    { ...writes, holds: ["index.html", "rows.js"] },
  ],
  ["--overlay <folder>", "write a PNG of each case: the image, the mask and the mesh", exports],
  ["--glb <folder>", "write the posed mesh of each case as a GLB file", exports],
  [
    "--upright",
    "give the meshes in exported files upright frames: up along the support, a tight box",
    {
      needs: { oneOf: ["glb", "sceneGlb", "mjcf", "urdf", "usd"], what: "--glb, --scene-glb, --mjcf, --urdf or --usd" },
    },
  ],
];

const ofCode = { needs: { oneOf: ["depthCode"], what: "--depth-code" } } as const;

/** Options of reading a case. */
export const caseFlags: readonly Flag[] = [
  ["--depth-scale <metres>", "metres per unit of depth, such as 0.001 for millimetres", { parse: number }],
  ["--depth-kind <kind>", "what the values of the depth map are (default metric)", { choices: depthKindNames }],
  ["--depth-code <name>", "the code of the depth map, if its values are no lengths", { choices: depthCodeNames }],
  ["--depth-near <metres>", "the near plane of a code, or the depth of its lowest value", { parse: number, ...ofCode }],
  ["--depth-far <metres>", "the far plane of a code, or the depth of its highest value", { parse: number, ...ofCode }],
  ["--image-id <id>", "image id in a BOP scene_camera.json"],
  ["--no-image", "do not read the photo: align by shape alone"],
  ["--resize-mask <how>", "resize the mask to the size of the depth map", { choices: ["nearest"] }],
  ["--mask-index <n>", "the place of the mask in a JSON file of several, from 0", { parse: number }],
];

const ofSimulators = { needs: { oneOf: ["mjcf", "urdf", "usd"], what: "--mjcf, --urdf or --usd" } } as const;

/** Files of a whole scene, of which there is one. */
export const sceneFileFlags: readonly Flag[] = [
  ["--scene-glb <file>", "write the scene as one GLB file", exports],
  [
    "--mjcf <folder>",
    "write the scene for MuJoCo: scene.xml and meshes",
    { ...exports, holds: ["meshes", "scene.xml"] },
  ],
  [
    "--urdf <folder>",
    "write the scene as URDF: a file per object, scene.json, load.py for PyBullet",
    { ...exports, holds: ["meshes", "load.py", "ground.urdf", "scene.json"] },
  ],
  ["--usd <file>", "write the scene as USD with physics (.usda)", exports],
  [
    "--density <kg/m³>",
    `mass per volume for simulators (default ${SIMULATOR_DEFAULTS.density})`,
    { parse: positive, ...ofSimulators },
  ],
  [
    "--parts <n>",
    `most convex parts of an object for simulators; 1 is its hull (default ${SIMULATOR_DEFAULTS.maxParts})`,
    { parse: count, ...ofSimulators },
  ],
  ["--no-rest", "keep all objects for simulators where they were found: they are not put at rest", ofSimulators],
];

/** The options of reading a case by the flags. */
export const caseSettings = ({ image, ...flags }: Flags): ReadCaseOptions => {
  const { depthScale, depthKind, depthCode, depthNear, depthFar, imageId, resizeMask, maskIndex } = flags;
  const files = { imageId, resizeMask, maskIndex, image: image === false ? false : undefined };
  return withoutUndefined({ depthScale, depthKind, depthCode, depthNear, depthFar, ...files });
};

/**
 * Adds flags to a command.
 * @param topic the argument of `--help`
 */
export function addFlags(command: Command, list: FlagList, topic?: string): void {
  for (const row of list) {
    if (typeof row === "string") {
      command.optionsGroup(row);
      continue;
    }
    const [flag, meaning, { choices, parse, default: value, isRequired = false, topic: of } = {}] = row;
    const option = new Option(flag, meaning).makeOptionMandatory(isRequired).hideHelp(of !== topic);
    if (choices !== undefined) option.choices(choices);
    if (parse !== undefined) option.argParser(parse);
    if (value !== undefined) option.default(value);
    command.addOption(option);
  }
}

/** The name of a flag without its value: `--jsonl`. */
export const nameOf = (flag: string) => flag.split(" ")[0] as string;

/** The name under which Commander stores the value of a flag. */
export const valueName = (flag: string) =>
  nameOf(flag)
    .replace(/^--(no-)?/, "")
    .replace(/-(.)/g, (_, letter: string) => letter.toUpperCase());

/** The files and folders that the flags read or write, in the order of the flags. */
export const filesOf = (list: FlagList, flags: Flags, use: "reads" | "writes"): (NamedFile & OutputName)[] =>
  withoutTitles(list).flatMap(([flag, , settings = {}]) => {
    const path = flags[valueName(flag)];
    if (settings.use !== use || typeof path !== "string" || settings.words?.includes(path)) return [];
    if (settings.isReplaceable) return [];
    const { isOwn, holds } = settings;
    return [{ flag: nameOf(flag), path, isFolder: flag.includes("<folder>"), isOwn, holds }];
  });

/** Whether a flag is on the command line. */
function isSet(flag: string, flags: Flags): boolean {
  const value = flags[valueName(flag)];
  return flag.startsWith("--no-") ? value === false : value !== undefined && value !== false;
}

/** @throws {@link UsageError} for files that do not exist; those of a case folder are reported for the case */
export function checkInputs(list: FlagList, flags: Flags): void {
  for (const [flag, , { use, words } = {}] of withoutTitles(list)) {
    const path = flags[valueName(flag)];
    if (use !== "reads" || typeof path !== "string" || words?.includes(path)) continue;
    if (statOf(path) === undefined)
      throw new UsageError(`${nameOf(flag)} ${path || '""'}: there is no such file or folder.`);
  }
}

/** @throws {@link UsageError} for flags that need others */
export function checkNeeds(list: FlagList, flags: Flags): void {
  for (const [flag, , { needs } = {}] of withoutTitles(list)) {
    if (
      needs !== undefined &&
      isSet(flag, flags) &&
      needs.oneOf.every((name) => (flags[name] ?? flags.options?.[name]) === undefined)
    )
      throw new UsageError(`${nameOf(flag)} needs ${needs.what}: without it, it does nothing.`);
  }
}

/**
 * The values of the flags that results depend on, by their names.
 * @param pathOf returns the path of a file as it is compared
 */
export const settingsOf = (list: FlagList, flags: Flags, pathOf: (path: string) => string): Record<string, unknown> =>
  Object.fromEntries(
    withoutTitles(list).flatMap(([flag, , { use, words, isIndifferent } = {}]) => {
      const value = flags[valueName(flag)];
      // The content of files is part of each row.
      if (!isSet(flag, flags) || use === "writes" || (isIndifferent && !isRecord(value))) return [];
      const isPath = use === "reads" && typeof value === "string" && !words?.includes(value);
      return [[nameOf(flag).slice(2), isPath ? pathOf(value) : flag.startsWith("--no-") || value]];
    }),
  );
