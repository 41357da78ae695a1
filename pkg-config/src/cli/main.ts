#!/usr/bin/env node
/** The command line program `sim3align`. */
import { Command, CommanderError } from "commander";
import { commands, runCommand } from "./commands.js";
import { UsageError } from "./files.js";
import { addFlags, withoutTitles } from "./flags.js";
import { programHelp } from "./help.js";
import { version } from "./record.js";
import { note } from "./terminal.js";

const program = new Command("sim3align")
  .description("Aligns generated 3D meshes with a masked depth map, in pose and metric scale.")
  .version(version)
  .addHelpText("after", programHelp);

/** The topic of `--help`, such as `paper` in `sim3align align --help paper`. */
const help = process.argv.findIndex((arg) => arg === "--help" || arg === "-h");
const topics = commands.flatMap(({ flags }) => withoutTitles(flags).flatMap(([, , facts]) => facts?.topic ?? []));
const topic = topics.find((one) => help >= 0 && one === process.argv[help + 1]);

for (const row of commands) {
  const command = new Command(row.name).summary(row.summary).description(row.description);
  if (row.argument !== undefined) command.argument(...row.argument);
  addFlags(command, row.flags, topic);
  command.addHelpText("after", topic === undefined ? row.help : "").action(async (...values) => {
    const [args, flags] = row.argument === undefined ? [[], values[0]] : [[values[0]].flat(), values[1]];
    if (!(await runCommand(row, args, flags))) process.exitCode = 1;
  });
  program.addCommand(command);
}

for (const command of [program, ...program.commands]) {
  command.exitOverride().showHelpAfterError('(see "--help")').configureHelp({ helpWidth: 110, sortOptions: false });
}

// "sim3align … | head" closes the pipe early, which is not an error.
const onError = (name: string) => (error: NodeJS.ErrnoException) => {
  if (error.code === "EPIPE") return;
  process.exitCode = 1;
  if (name === "stdout") note(`error: stdout: cannot be written: ${error.message}.`);
};
process.stdout.once("error", onError("stdout")).on("error", () => {});
process.stderr.once("error", onError("stderr")).on("error", () => {});

try {
  await program.parseAsync();
} catch (error) {
  // Commander has already printed its errors.
  const isPrinted = error instanceof CommanderError;
  if (!isPrinted) note(`error: ${error instanceof Error ? error.message : String(error)}`);
  const isUsage = error instanceof UsageError || (isPrinted && error.exitCode !== 0);
  process.exitCode = isUsage ? 2 : isPrinted ? (process.exitCode ?? 0) : 1;
}
