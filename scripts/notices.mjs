/** `npm run notices`: writes the licences of the code in the package; to be committed. `npm test` checks that nothing differs. */
import { writeNotice } from "./lib/notices.mjs";
import { rustToolchain } from "./lib/setup.mjs";
import { script, step } from "./lib/step.mjs";

await script(async () => {
  await rustToolchain();
  await step("third-party notices", writeNotice);
});
