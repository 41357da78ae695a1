/** `npm run docs`: the API reference, below target/docs. */
import { writeApiDocs } from "./lib/api-docs.mjs";
import { setUp } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";
import { buildWasm } from "./lib/wasm.mjs";

await script(async () => {
  await setUp();
  await buildWasm();
  await step("API reference", async (say) => {
    await writeApiDocs();
    say("target/docs/index.html");
  });
});
