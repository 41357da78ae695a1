#!/usr/bin/env node
/** `sim3align`: the command line. */
import { readFileSync } from "node:fs";
import { Command, CommanderError } from "commander";
import { alignCommand } from "./cli/align-command.js";
import { statusHelp } from "./cli/case-options.js";
import { evaluateCommand } from "./cli/evaluate-command.js";
import { UsageError } from "./cli/usage-error.js";

const { version } = JSON.parse(readFileSync(new URL("./package.json", import.meta.url), "utf8")) as { version: string };

const help = `
Examples
  sim3align align cases/mug                      align one case and show everything about it
  sim3align align cases/* --json results.json    align many, with a table and a file of results
  sim3align evaluate cases/mug --transform results.json

"sim3align align --help" tells what a case folder holds, and in which frames and units the results are.
${statusHelp}`;

const program = new Command("sim3align")
  .description("Puts a generated 3D mesh where it really is, at its real size, from one masked depth map.")
  .version(version)
  .addCommand(alignCommand())
  .addCommand(evaluateCommand())
  .addHelpText("after", help);

for (const command of [program, ...program.commands]) {
  command.exitOverride().showHelpAfterError('(see "--help")').configureHelp({ helpWidth: 110, sortOptions: false });
}

// "sim3align … | head" closes the pipe early, which is no fault.
process.stdout.on("error", (error: NodeJS.ErrnoException) => {
  if (error.code !== "EPIPE") throw error;
});

try {
  await program.parseAsync();
} catch (error) {
  if (error instanceof CommanderError) {
    // Commander has said what is wrong, if something is.
    process.exitCode = error.exitCode === 0 ? 0 : 2;
  } else if (error instanceof UsageError) {
    console.error(`error: ${error.message}`);
    process.exitCode = 2;
  } else {
    console.error(`error: ${error instanceof Error ? error.message : String(error)}`);
    process.exitCode = 1;
  }
}
