/** Environments of Python, below `target/bench`. */
import { existsSync, rmSync } from "node:fs";
import { join } from "node:path";
import { cached, digest } from "./cache.mjs";
import { at } from "./paths.mjs";
import { run } from "./run.mjs";
import { step } from "./step.mjs";

/** @param {string} folder */
const pythonIn = (folder) =>
  process.platform === "win32" ? join(folder, "Scripts", "python.exe") : join(folder, "bin", "python");

/**
 * The Python of an environment with the packages of `scripts/bench/NAME/requirements.txt`, which is made where it is missing.
 * @param {string} name
 * @param {string} [program] the Python that makes it
 */
export async function pythonWith(name, program = "python3") {
  const requirements = at("scripts", "bench", name, "requirements.txt");
  const install = () =>
    pythonOf(at("target", "bench", name), digest([requirements]), ["--requirement", requirements], program);
  return step("Python libraries", install);
}

/**
 * The Python of an environment in a folder, which is made where it is missing or was made from something else.
 * @param {string} folder
 * @param {string} inputs the digest of what it is made from
 * @param {readonly string[]} packages arguments of `pip install`
 * @param {string} program the Python that makes it
 */
export async function pythonOf(folder, inputs, packages, program) {
  const python = pythonIn(folder);
  await cached(join(folder, "installed-from"), inputs, [python], async () => {
    rmSync(folder, { recursive: true, force: true });
    const remedy = "install Python 3.11 or 3.12 with venv, name it with --python, and check that PyPI can be reached";
    await run(program, ["-m", "venv", folder], { remedy });
    await run(python, ["-m", "pip", "install", "--quiet", ...packages], { remedy });
  });
  return python;
}

/**
 * Runs the Python package `scripts/bench/NAME` in its environment, and returns what it prints.
 * @param {string} name
 * @param {readonly string[]} args
 * @param {string | undefined} program the Python that makes the environment
 */
export async function runPython(name, args, program) {
  const env = { PYTHONPATH: at("scripts", "bench"), PYTHONDONTWRITEBYTECODE: "1" };
  return run(await pythonWith(name, program), ["-m", name, ...args], { env, echo: "errors" });
}

/**
 * The Python of an environment that is there; made in continuous integration only (`CI` set), if the packages are to be had
 * for its Python.
 * @param {string} name
 * @returns {Promise<string | undefined>}
 */
export async function installedPython(name) {
  if (process.env.CI) return pythonWith(name).catch(() => undefined);
  const python = pythonIn(at("target", "bench", name));
  return existsSync(python) ? python : undefined;
}
