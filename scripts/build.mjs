/** `npm run build`: writes the publishable package to pkg/. */
import { buildPackage } from "./lib/package.mjs";
import { script } from "./lib/step.mjs";

await script(buildPackage);
