/** `npm run samples`: generates the page's samples anew; to be committed. `npm test` checks that nothing differs. */
import { generateSamples, pageSamplesDir } from "./lib/sample.mjs";
import { rustToolchain } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";

await script(async () => {
  await rustToolchain();
  await step("samples", () => generateSamples(pageSamplesDir));
});
