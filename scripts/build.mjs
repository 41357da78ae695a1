/** `npm run build`: writes the publishable package, whole, to pkg/. */
import { buildPackage } from "./lib/package.mjs";
import { setUp } from "./lib/setup.mjs";
import { script } from "./lib/step.mjs";

await script(async () => {
  await setUp();
  await buildPackage();
});
