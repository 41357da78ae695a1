/** Every command of package.json in its smallest form; building, formatting and testing are suites of their own. */
import { at } from "../lib/paths.mjs";
import { run } from "../lib/run.mjs";
import { runChecks } from "../lib/step.mjs";

/** The scripts, with the arguments that make them small. @type {readonly (readonly string[])[]} */
const smallest = [
  ["record", "--quick", "--check"],
  ["start", "--check"],
];
/** Those that measure for long. @type {typeof smallest} */
const measuring = [
  ["bench", "--smallest"],
  ["fit", "--cases", "36", "--test-cases", "12"],
  ["speed", "--quick"],
  ["physics"],
];

/** The lab's program is that of the native tests. */
const env = { SIM3ALIGN_LAB_PROFILE: "dev" };

/** @param {string} output */
const lastLine = (output) => output.trimEnd().split("\n").at(-1)?.trim() ?? "";

/** @param {boolean} isAll */
export const commands = (isAll) =>
  runChecks(
    [...smallest, ...(isAll ? measuring : [])].map(([name = "", ...args]) => [
      `npm run ${name} -- ${args.join(" ")}`,
      async (say) => say(lastLine(await run(process.execPath, [at("scripts", `${name}.mjs`), ...args], { env }))),
    ]),
  );
