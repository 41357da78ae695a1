/** `node scripts/check-size.mjs`: whether the built package keeps within its budgets. */
import { explain } from "./lib/step.mjs";
import { checkSizes } from "./suites/size.mjs";

try {
  const { failed } = await checkSizes();
  if (failed > 0) process.exitCode = 1;
} catch (error) {
  explain(error);
  process.exitCode = 1;
}
