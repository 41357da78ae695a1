#!/usr/bin/env node
/** The command line program `sim3align`. */
import { readFileSync } from "node:fs";
import { Command, CommanderError } from "commander";
import { alignCommand } from "./align-command.js";
import { bopCommand } from "./bop-command.js";
import { statusHelp } from "./case-options.js";
import { evaluateCommand } from "./evaluate-command.js";
import { sceneCommand } from "./scene-command.js";
import { trackCommand } from "./track-command.js";
import { UsageError } from "./usage-error.js";

const { version } = JSON.parse(readFileSync(new URL("../package.json", import.meta.url), "utf8")) as {
  version: string;
};

const help = `
Examples
  sim3align align cases/mug                      align one case and show everything about it
  sim3align align cases/* --json results.json    align several cases; print a table and write a JSON file
  sim3align scene scenes/desk --scene-glb desk.glb     align all objects of a scene; write it as one file
  sim3align track videos/mug                     track an object through the frames of a video
  sim3align evaluate cases/mug --transform results.json
  sim3align bop bop/lmo --split test --evaluate    align the targets of a BOP dataset, and score them

See "sim3align align --help" for the layout of a case folder, and for the frames and units of the results.
${statusHelp}`;

const program = new Command("sim3align")
  .description("Aligns generated 3D meshes with a masked depth map, in pose and metric scale.")
  .version(version)
  .addCommand(alignCommand())
  .addCommand(trackCommand())
  .addCommand(evaluateCommand())
  .addCommand(sceneCommand())
  .addCommand(bopCommand())
  .addHelpText("after", help);

for (const command of [program, ...program.commands]) {
  command.exitOverride().showHelpAfterError('(see "--help")').configureHelp({ helpWidth: 110, sortOptions: false });
}

// "sim3align … | head" closes the pipe early, which is not an error.
process.stdout.on("error", (error: NodeJS.ErrnoException) => {
  if (error.code !== "EPIPE") throw error;
});

try {
  await program.parseAsync();
} catch (error) {
  if (error instanceof CommanderError) {
    // Commander has already printed the error, if any.
    process.exitCode = error.exitCode === 0 ? 0 : 2;
  } else if (error instanceof UsageError) {
    console.error(`error: ${error.message}`);
    process.exitCode = 2;
  } else {
    console.error(`error: ${error instanceof Error ? error.message : String(error)}`);
    process.exitCode = 1;
  }
}
