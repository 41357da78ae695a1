/** The examples, each as its user runs it: with the packed package, installed. */
import { cpSync, mkdirSync, readdirSync, renameSync, rmSync } from "node:fs";
import { basename, join } from "node:path";
import { chromium } from "../lib/chromium.mjs";
import { at, packageDir } from "../lib/paths.mjs";
import { redisServer } from "../lib/redis.mjs";
import { run } from "../lib/run.mjs";
import { makeSample, sampleDir } from "../lib/sample.mjs";
import { digest, filesBelow, Stamp } from "../lib/stamp.mjs";
import { step } from "../lib/step.mjs";
import { install, runCompiled } from "./package.mjs";

/** A copy of the repository, as far as the examples know it: what npm packed in pkg/, and they beside it. */
const copy = at("target", "examples");
const folder = join(copy, "examples");

/** What makes itself in a folder that is worked in. */
const made = new Set(["node_modules", "sample", "dist", "annotation"]);
const isSource = (/** @type {string} */ path) => !made.has(basename(path));

/**
 * What decides on the packages to be installed.
 * @param {string} examples
 */
const manifests = (examples) =>
  readdirSync(examples)
    .filter(isSource)
    .flatMap((name) => filesBelow([join(examples, name)]))
    .filter((path) => /^(package(-lock)?\.json|\.npmrc)$/.test(basename(path)));

/** Installs what the examples need, and copies them as they are now. */
export async function installExamples() {
  await step("install the examples", async (say) => {
    const inputs = digest([packageDir, ...manifests(at("examples"))]);
    const stamp = new Stamp(join(copy, "installed-from"), inputs, [join(folder, "node_modules")]);
    if (stamp.isCurrent) return say("up to date");
    rmSync(copy, { recursive: true, force: true });
    mkdirSync(folder, { recursive: true });
    const [packed] = JSON.parse(await run("npm", ["pack", packageDir, "--json", "--pack-destination", copy]));
    await run("tar", ["-xzf", packed.filename], { cwd: copy });
    renameSync(join(copy, "package"), join(copy, "pkg"));
    cpSync(at("examples"), folder, { recursive: true, filter: isSource });
    await run("npm", ["ci", "--prefer-offline"], {
      cwd: folder,
      remedy: "check that the npm registry can be reached, and that examples/package-lock.json is up to date",
    });
    stamp.write();
  });
  cpSync(at("examples"), folder, { recursive: true, filter: isSource });
  cpSync(sampleDir, join(folder, "sample", "mug"), { recursive: true });
}

export async function examples() {
  await makeSample();
  await install();
  await installExamples();
  return runCompiled("examples", {
    SIM3ALIGN_EXAMPLES: folder,
    CHROMIUM_PATH: (await chromium()) ?? "",
    REDIS_SERVER_PATH: (await redisServer()) ?? "",
  });
}
