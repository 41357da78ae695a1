/** `npm run build:www`: writes the static site to target/www. */
import { buildPackage } from "./lib/package.mjs";
import { setUp } from "./lib/setup.mjs";
import { buildSite } from "./lib/site.mjs";
import { script } from "./lib/step.mjs";

await script(async () => {
  await setUp();
  await buildPackage();
  await buildSite();
});
