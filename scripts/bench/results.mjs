/** The folder of a benchmark's results, from which an interrupted run is resumed. */
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, platform, release, totalmem } from "node:os";
import { join } from "node:path";
import { attempt } from "../lib/run.mjs";

/**
 * Opens the folder of a run. `identity`, its inputs and the digest of the code, distinguishes it from other runs.
 * @param {string} folder
 * @param {Record<string, unknown>} identity
 * @param {boolean} fresh forget what is there
 */
export function openResults(folder, identity, fresh) {
  if (fresh) rmSync(folder, { recursive: true, force: true });
  mkdirSync(join(folder, "records"), { recursive: true });
  const file = join(folder, "identity.json");
  const text = `${JSON.stringify(identity, null, 2)}\n`;
  if (existsSync(file) && readFileSync(file, "utf8") !== text) {
    const remedy = "Remedy: --fresh forgets them, --out DIR leaves them as they are.";
    throw new Error(`${folder} holds results of other inputs or another version of the code. ${remedy}`);
  }
  writeFileSync(file, text);
}

/** The file of the records of a kind of mesh. @param {string} folder @param {string} prior */
export const recordsFile = (folder, prior) => join(folder, "records", `${prior}.jsonl`);

/** Machine and versions, for people who compare figures. */
export async function environment() {
  const said = async (/** @type {string} */ command, /** @type {string[]} */ args) =>
    (await attempt(command, args)).output.trim();
  const [commit, changes, rustc] = await Promise.all([
    said("git", ["rev-parse", "HEAD"]),
    said("git", ["status", "--porcelain", "--untracked-files=no"]),
    said("rustc", ["--version"]),
  ]);
  const processors = cpus();
  return {
    commit: changes === "" ? commit : `${commit} with changes`,
    date: new Date().toISOString(),
    machine: `${processors.length} × ${processors[0]?.model.trim() ?? "?"}, ${Math.round(totalmem() / 2 ** 30)} GiB`,
    system: `${platform()} ${release()}`,
    node: process.version,
    rustc,
  };
}
