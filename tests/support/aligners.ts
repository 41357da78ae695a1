/** Aligners that a file of tests shares. */
import { after } from "node:test";
import { type Aligner, createAligner } from "sim3align";

/** Aligners with these numbers of workers, disposed of after the tests of a file. */
export async function pools<const N extends readonly number[]>(...numbers: N): Promise<{ [I in keyof N]: Aligner }> {
  const made = await Promise.all(numbers.map((workers) => createAligner({ workers })));
  after(() => {
    for (const aligner of made) aligner.dispose();
  });
  return made as { [I in keyof N]: Aligner };
}
