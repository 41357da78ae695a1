/** The flags of all commands that work on many folders: which folders, what is written, and how many at a time. */
import type { Command } from "commander";
import type { FolderKind } from "./folders.js";
import type { OutputFlags } from "./output.js";
import { workers } from "./parse.js";

/** Values of the flags. */
export interface BatchFlags extends OutputFlags {
  list?: string;
  workers?: number | "auto";
}

/** A flag, and its description for folders of a kind. */
type Row = readonly [flag: string, describe: (noun: string) => string, parse?: typeof workers];

/** What is written, and how many folders are worked on at a time. */
const recordFlags: readonly Row[] = [
  ["--json <file>", () => 'write the results as JSON; "-" is stdout'],
  ["--jsonl <file>", (noun) => `write a line of JSON for each ${noun} when it is done; "-" is stdout`],
  ["--resume", (noun) => `go on: skip the ${noun}s in the file of --jsonl, and append to it`],
  ["--workers <n|auto>", (noun) => `${noun}s at a time (1 to 64; default auto: one per core)`, workers],
];

const folderFlags: readonly Row[] = [
  ["--list <file>", (noun) => `a file with the path of a ${noun} folder per line; "-" is stdin`],
  ...recordFlags,
  ["--csv <file>", () => 'write a table of comma-separated values; "-" is stdout'],
];

/** Adds the argument for folders and the flags to a command. */
export function addBatchFlags(command: Command, { noun }: FolderKind): Command {
  return added(
    command.argument(`[${noun}...]`, `${noun} folders, or patterns such as '${noun}s/*'`),
    folderFlags,
    noun,
  );
}

/** Adds only the flags of what is written and of the workers. */
export const addRecordFlags = (command: Command, noun: string): Command => added(command, recordFlags, noun);

function added(command: Command, rows: readonly Row[], noun: string): Command {
  for (const [flag, describe, parse] of rows) {
    if (parse === undefined) command.option(flag, describe(noun));
    else command.option(flag, describe(noun), parse);
  }
  return command;
}

/** What the flags do, for --help. */
export const batchHelp = ({ noun, mark }: FolderKind) => `
Batches
  The ${noun}s are worked on side by side; the results do not depend on --workers. Each is read when its turn comes: memory
  grows with the number of workers, not with that of the ${noun}s. A pattern in quotes is expanded by this program:
  * and ? within a name, [abc], {a,b}, and ** for folders at any depth, of which those with ${mark} are taken. Paths in a
  list are relative to the current folder, and stand for themselves; empty lines and lines that begin with # are skipped.
  A terminal shows a bar with rate, time left and failures; elsewhere, a batch of 20 or more prints a line per tenth.
  Rows and entries are written when a ${noun} is done, in the order in which they end; with --workers 1, in that of the
  command line. An interruption loses nothing: the files hold what is done.
  --jsonl writes the entries of --json, a line each: { "case", "path", "content", … }. It is the record of a batch: after an
  interruption, of whatever kind, the same command with --resume does what is missing. A ${noun} is known by its path
  relative to the record, whatever else is given and from wherever; one that has moved, by the checksum of its files. One
  program at a time writes a record, which FILE.lock says. A line that was cut off is removed. What failed counts as done;
  remove its lines to try again. --json and --csv are then written anew from the record.`;
