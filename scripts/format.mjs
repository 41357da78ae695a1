/** `npm run format`: formats everything, and applies the linter's safe corrections. */
import { nodeProgram, run } from "./lib/run.mjs";
import { npmPackages, rustToolchain } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";

await script(async () => {
  await Promise.all([npmPackages(), rustToolchain()]);
  await step("Rust", () => run("cargo", ["fmt", "--all"]));
  const [node, biome] = nodeProgram("@biomejs/biome", "biome");
  await step("everything else", () => run(node, [biome, "check", "--write", "--error-on-warnings"]));
});
