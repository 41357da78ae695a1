/** The guard of accuracy: this version on a part of each set, against the record in the repository. */

import { runChecks } from "../lib/step.mjs";
import { record } from "../record/record.mjs";

/** Runs the program that the tests of the lab run, which has the same bits as the native one. */
export const guard = () =>
  runChecks([
    [
      "nothing is worse than in docs/record/quick.json",
      async () => {
        const lost = await record({ quick: true, check: true, tested: true });
        if (lost.length > 0)
          throw new Error(
            `${lost.join("\n")}\nRemedy: mend it; or, if the loss is meant, say why and run \`npm run record -- --quick --save\`.`,
          );
      },
    ],
  ]);
