/** `npm run format`: formats everything, and applies the linter's safe corrections. */
import { nodeProgram, run } from "./lib/run.mjs";
import { setUp } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";

await script(async () => {
  await setUp();
  await step("Rust", () => run("cargo", ["fmt", "--all"]));
  const [node, biome] = nodeProgram("@biomejs/biome", "biome");
  await step("everything else", () => run(node, [biome, "check", "--write", "--error-on-warnings"]));
});
