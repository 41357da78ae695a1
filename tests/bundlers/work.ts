/** The calls of the apps, and the report of their results. */
import type { Aligner, AlignerOptions, AlignInput } from "sim3align";
import { input, mesh } from "../support/scene.js";

/** The matrices of all calls, which have to equal those of Node. */
export type Found = Record<string, number[]>;

/** Aligns arrays, a file and a scene of one object, without workers and with two. */
export async function work(
  createAligner: (options?: AlignerOptions) => Promise<Aligner>,
  numbers: readonly number[] = [0, 2],
): Promise<Found> {
  const quick = { quality: "fast" } as const;
  const file: AlignInput = { ...input, mesh: { bytes: new TextEncoder().encode(obj()), format: "obj" } };
  const found: Found = {};
  for (const workers of numbers) {
    const aligner = await createAligner({ workers });
    found[`arrays, ${workers}`] = Array.from((await aligner.align(input, quick)).matrix);
    found[`file, ${workers}`] = Array.from((await aligner.align(file, quick)).matrix);
    const { mask, mesh, ...view } = input;
    const { objects } = await aligner.alignScene({ ...view, objects: [{ mask, mesh }], support: null }, quick);
    found[`scene, ${workers}`] = objects.flatMap((object) => (object.error === undefined ? object.matrix : []));
    for await (const { index, alignment } of aligner.alignAll([input, input], { ...quick, ordered: true })) {
      found[`all, ${workers}, ${index}`] = Array.from(alignment?.matrix ?? []);
    }
    aligner.dispose();
  }
  return found;
}

function obj(): string {
  const lines: string[] = [];
  const { positions, indices } = mesh;
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions.slice(i, i + 3).join(" ")}`);
  for (let i = 0; i < indices.length; i += 3) {
    lines.push(`f ${Array.from(indices.slice(i, i + 3), (index) => index + 1).join(" ")}`);
  }
  return `${lines.join("\n")}\n`;
}

/** Puts what came of it where the test finds it. */
export function show(found: Promise<Found>): void {
  const element = document.createElement("pre");
  element.id = "outcome";
  const say = (text: string) => {
    element.textContent = text;
    document.body.append(element);
  };
  found.then(
    (result) => say(JSON.stringify(result)),
    (error: unknown) => say(JSON.stringify({ error: String(error) })),
  );
}
