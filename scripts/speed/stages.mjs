/** Time of an alignment by stage, natively and as WebAssembly on one thread, in one run. */

import { fixed, markdownTable, median } from "../bench/table.mjs";
import { runLab } from "../lib/lab.mjs";
import { createAligner, readTypedCase } from "./inputs.mjs";

/** @typedef {{ matrix: number[], diagnostics: { timingsMs: Record<string, number> } }} Result */

const TETRAHEDRON = Uint32Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3);

/** @param {readonly Result[]} results @param {string} stage */
const milliseconds = (results, stage) => median(results.map(({ diagnostics }) => diagnostics.timingsMs[stage] ?? NaN));

/**
 * Prints one table a case, and whether both builds give the same bits.
 * @param {readonly string[]} folders
 * @param {{ runs: number, quality: string }} options
 */
export async function measureStages(folders, { runs, quality }) {
  const aligner = await createAligner();
  const tetrahedron = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), indices: TETRAHEDRON };
  for (const folder of folders) {
    const { name, input } = await readTypedCase(folder);
    /** @type {Record<string, Result[]>} */
    const native = JSON.parse(await runLab(["profile", "--quality", quality, `${runs}`, folder]));
    const [there = []] = Object.values(native);
    /** @type {Result[]} */
    const here = [];
    /** @type {number[]} */
    const whole = [];
    /** @type {number[]} */
    const again = [];
    /** @type {number[]} */
    const bare = [];
    const mesh = await aligner.prepareMesh(input.mesh);
    // The first run compiles.
    for (let run = -1; run < runs; run++) {
      // The aligner keeps the last mesh: after this one, it analyses that of the case anew.
      await aligner.align({ ...input, mesh: tetrahedron }, { quality: "fast", metrics: false }).catch(() => {});
      const times = [performance.now()];
      const result = await aligner.align(input, { quality });
      times.push(performance.now());
      await aligner.align(input, { quality });
      times.push(performance.now());
      await aligner.align({ ...input, mesh }, { quality, metrics: false });
      times.push(performance.now());
      if (run < 0) continue;
      here.push(result);
      for (const [i, list] of [whole, again, bare].entries()) list.push((times[i + 1] ?? NaN) - (times[i] ?? NaN));
    }
    mesh.dispose();
    const rows = Object.keys(here[0]?.diagnostics.timingsMs ?? {}).map((stage) => [
      stage,
      fixed(milliseconds(there, stage), 1),
      fixed(milliseconds(here, stage), 1),
    ]);
    rows.push(["call", "", fixed(median(whole), 1)], ["the same mesh again", "", fixed(median(again), 1)]);
    rows.push(["prepared mesh, no metrics", "", fixed(median(bare), 1)]);
    const title = `${name}, ${input.mesh.indices.length / 3} triangles, ${quality}`;
    console.log(`\n${markdownTable([title, "native, ms", "WebAssembly, ms"], rows)}`);
    const isSame = there[0]?.matrix.join() === here[0]?.matrix.join();
    console.log(`\nThe matrices ${isSame ? "are the same to the bit" : "differ"}.`);
    if (!isSame) process.exitCode = 1;
  }
}
