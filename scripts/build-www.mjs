/** `npm run build:www`: writes the static site to target/www. */
import { buildSite } from "./lib/site.mjs";
import { script } from "./lib/step.mjs";

await script(buildSite);
