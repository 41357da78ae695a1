/** `npm run api-report`: writes the report of the package's API; to be committed. `npm test` checks that nothing differs. */
import { writeApiReport } from "./lib/api-report.mjs";
import { buildPackage } from "./lib/package.mjs";
import { script, step } from "./lib/step.mjs";

await script(async () => {
  await buildPackage();
  await step("API report", writeApiReport);
});
