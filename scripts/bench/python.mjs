/** Python environments of the benchmarks, each with pinned requirements, below `target/bench`. */
import { rmSync } from "node:fs";
import { join } from "node:path";
import { at } from "../lib/paths.mjs";
import { run } from "../lib/run.mjs";
import { digest, Stamp } from "../lib/stamp.mjs";
import { step } from "../lib/step.mjs";

/** Where our own Python is found, which leaves nothing beside its sources. */
export const pythonVariables = { PYTHONPATH: at("scripts", "bench"), PYTHONDONTWRITEBYTECODE: "1" };

/**
 * Makes an environment where it is missing or its requirements have changed.
 * @param {string} name what is installed, and the name of its folder
 * @param {string} requirements a requirements.txt
 * @param {string} program the Python that makes it
 * @returns {Promise<string>} the environment's own Python
 */
export async function pythonEnvironment(name, requirements, program) {
  const folder = at("target", "bench", name);
  const python = process.platform === "win32" ? join(folder, "Scripts", "python.exe") : join(folder, "bin", "python");
  const stamp = new Stamp(join(folder, "installed-from"), digest([requirements]), [python]);
  if (stamp.isCurrent) return python;
  await step(`Python, ${name}`, async (say) => {
    rmSync(folder, { recursive: true, force: true });
    const remedy = "install Python 3.11 or 3.12 with venv, name it with --python, and check that PyPI can be reached";
    await run(program, ["-m", "venv", folder], { remedy });
    await run(python, ["-m", "pip", "install", "--quiet", "--requirement", requirements], { remedy });
    stamp.write();
    say("installed");
  });
  return python;
}
