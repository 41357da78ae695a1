/** Time of an alignment by stage, as WebAssembly on one thread. */

import { fixed, markdownTable, median } from "../bench/table.mjs";
import { createAligner, readTypedCase } from "./inputs.mjs";

/** @typedef {{ diagnostics: { timingsMs: Record<string, number> } }} Result */

/** Another mesh than that of any case. */
const tetrahedron = {
  positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1),
  indices: Uint32Array.of(0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3),
};

/** @param {readonly Result[]} results @param {string} stage */
const milliseconds = (results, stage) => median(results.map(({ diagnostics }) => diagnostics.timingsMs[stage] ?? NaN));

/**
 * Prints one table a case.
 * @param {readonly string[]} folders
 * @param {{ runs: number, quality: string }} options
 */
export async function measureStages(folders, { runs, quality }) {
  const aligner = await createAligner();
  for (const folder of folders) {
    const { name, input } = await readTypedCase(folder);
    /** @type {Result[]} */
    const here = [];
    /** @type {number[]} */
    const whole = [];
    /** @type {number[]} */
    const again = [];
    /** @type {number[]} */
    const bare = [];
    const mesh = await aligner.prepareMesh(input.mesh);
    /** @param {number[]} list @param {() => Promise<Result>} call */
    const timed = async (list, call) => {
      const began = performance.now();
      const result = await call();
      list.push(performance.now() - began);
      return result;
    };
    for (let run = -1; run < runs; run++) {
      // The first run compiles.
      if (run === 0) for (const list of [here, whole, again, bare]) list.length = 0;
      // The aligner keeps the last mesh: after this one, it analyses that of the case anew.
      await aligner.align({ ...input, mesh: tetrahedron }, { quality: "fast", metrics: false }).catch(() => {});
      here.push(await timed(whole, () => aligner.align(input, { quality })));
      await timed(again, () => aligner.align(input, { quality }));
      await timed(bare, () => aligner.align({ ...input, mesh }, { quality, metrics: false }));
    }
    mesh.dispose();
    const rows = Object.keys(here[0]?.diagnostics.timingsMs ?? {}).map((stage) => [
      stage,
      fixed(milliseconds(here, stage), 1),
    ]);
    rows.push(["call", fixed(median(whole), 1)], ["the same mesh again", fixed(median(again), 1)]);
    rows.push(["prepared mesh, no metrics", fixed(median(bare), 1)]);
    const title = `${name}, ${input.mesh.indices.length / 3} triangles, ${quality}`;
    console.log(`\n${markdownTable([title, "ms"], rows)}`);
  }
}
