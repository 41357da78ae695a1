/** `npm run docs`: writes the API reference to target/docs. */
import { writeApiDocs } from "./lib/api-docs.mjs";
import { script, step } from "./lib/step.mjs";
import { buildWasm } from "./lib/wasm.mjs";

await script(async () => {
  await buildWasm();
  await step("API reference", writeApiDocs);
});
