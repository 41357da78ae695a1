/** Other programs, run to their end. */
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { homedir } from "node:os";
import { delimiter, join } from "node:path";
import { print } from "./output.mjs";
import { at, repository } from "./paths.mjs";

/** A command that failed: what it was, what it said, and what to do about it. */
export class CommandError extends Error {
  /**
   * @param {string} commandLine
   * @param {string} reason
   * @param {string} output
   * @param {string} remedy
   */
  constructor(commandLine, reason, output, remedy) {
    super(`${commandLine}: ${reason}`);
    this.name = "CommandError";
    this.commandLine = commandLine;
    this.output = output;
    this.remedy = remedy;
  }
}

/**
 * The environment of every program: cargo on the path, and the repository's target folder.
 * @returns {NodeJS.ProcessEnv}
 */
function environment() {
  const cargoBin = join(process.env.CARGO_HOME ?? join(homedir(), ".cargo"), "bin");
  const path = [process.env.PATH, cargoBin].filter(Boolean).join(delimiter);
  return { ...process.env, PATH: path, CARGO_TARGET_DIR: at("target"), CARGO_TERM_PROGRESS_WHEN: "never" };
}

/**
 * @typedef {object} RunOptions
 * @property {string} [remedy] what to do when the command fails
 * @property {string} [cwd] the working directory; the repository by default
 * @property {NodeJS.ProcessEnv} [env] added to the environment
 * @property {boolean | "errors"} [echo] print the output, or pass on standard error alone, as it comes, besides
 * returning it
 * @property {boolean} [attach] let the command have the console, and return nothing; others, which print nothing for
 * {@link SILENCE_MINUTES}, hang, and are ended
 */

/** Far longer than a test, a compilation or a download takes between two lines, on a busy machine too. */
const SILENCE_MINUTES = 20;

/**
 * Runs a command to its end, whatever that end is.
 * @param {string} command
 * @param {readonly string[]} args
 * @param {RunOptions} [options]
 * @returns {Promise<{ output: string, stdout: string, reason: string, hung: boolean }>} the output is standard output
 * and error together; the reason is empty after a success; a command that hung was ended
 */
export function attempt(command, args, options = {}) {
  return new Promise((resolve) => {
    const child = spawn(command, args, {
      cwd: options.cwd ?? repository,
      env: { ...environment(), ...options.env },
      stdio: options.attach ? "inherit" : ["ignore", "pipe", "pipe"],
      // npm and npx are batch files there, which only the shell starts.
      shell: process.platform === "win32" && /^np[mx]$/.test(command),
    });
    let [output, stdout] = ["", ""];
    const watch = () => {
      end(`ended, for it printed nothing for ${SILENCE_MINUTES} minutes`, true);
      child.kill();
      // What the command itself has started may live on, and must not keep this process.
      child.stdout?.destroy();
      child.stderr?.destroy();
      child.unref();
    };
    const watchdog = options.attach ? undefined : setTimeout(watch, SILENCE_MINUTES * 60_000);
    child.stdout?.setEncoding("utf8");
    child.stderr?.setEncoding("utf8");
    child.stdout?.on("data", (chunk) => {
      watchdog?.refresh();
      output += chunk;
      stdout += chunk;
      if (options.echo === true) print(chunk);
    });
    child.stderr?.on("data", (chunk) => {
      watchdog?.refresh();
      output += chunk;
      if (options.echo === true) print(chunk);
      else if (options.echo) process.stderr.write(chunk);
    });
    const end = (/** @type {string} */ reason, hung = false) => {
      clearTimeout(watchdog);
      resolve({ output, stdout, reason, hung });
    };
    child.on("error", (error) => end(error.message));
    child.on("close", (code, signal) => {
      end(code === 0 ? "" : signal ? `ended by ${signal}` : `exit status ${code}`);
    });
  });
}

/**
 * Runs a command and returns its standard output.
 * @param {string} command
 * @param {readonly string[]} args
 * @param {RunOptions} [options]
 * @throws {CommandError} when it does not start or does not succeed
 */
export async function run(command, args, options = {}) {
  const { output, stdout, reason } = await attempt(command, args, options);
  if (reason) throw new CommandError([command, ...args].join(" "), reason, output, options.remedy ?? "");
  return stdout;
}

/**
 * The command line of a program in node_modules.
 * @param {string} name the npm package
 * @param {string} [program] its program, where that is named otherwise
 * @returns {[command: string, script: string]}
 */
export function nodeProgram(name, program = name) {
  const folder = at("node_modules", name);
  const { bin } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const script = join(folder, typeof bin === "string" ? bin : bin[program]);
  return [process.execPath, script];
}
