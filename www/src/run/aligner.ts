/** The page's aligner: workers, so that nothing here has to wait. */
import { type Aligner, createAligner } from "sim3align";

let made: Promise<Aligner> | undefined;

/** The aligner, made once; after a failure the next call tries again. */
export function aligner(): Promise<Aligner> {
  if (made === undefined) {
    const making = createAligner({ workers: "auto" });
    making.catch(() => {
      made = undefined;
    });
    made = making;
  }
  return made;
}
