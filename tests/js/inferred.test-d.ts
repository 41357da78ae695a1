/** What a compiler infers can be written into the declarations of a library that uses the package. It is compiled, and never run. */
import type { Aligner, AlignInput, SceneInput, Tracker, ViewsInput } from "sim3align";
import {
  correctDepth,
  cropInput,
  fromBop,
  fromRle,
  generatorFrames,
  orientedBoundingBox,
  toBop,
  toCuboid,
  toSam3d,
  uprightMesh,
} from "sim3align/conventions";

declare const mesh: { positions: Float32Array };

export const aligned = async (aligner: Aligner, input: AlignInput) => {
  const result = await aligner.align(input);
  const { diagnostics, alternatives, uncertainty, proportions, depthCalibration } = result;
  const { counts, timingsMs, terms, color } = diagnostics;
  const parts = { alternatives, uncertainty, proportions, depthCalibration };
  return { result, diagnostics, ...parts, counts, timingsMs, terms, color };
};
export const paper = async (aligner: Aligner, input: AlignInput) => {
  const { diagnostics } = await aligner.align(input, { preset: "paper" });
  return { diagnostics, counts: diagnostics.counts };
};
export const scene = async (aligner: Aligner, input: SceneInput) => {
  const { objects, support, metrics } = await aligner.alignScene(input);
  const contacts = objects.map((object) => object.error ?? object.contact);
  return { objects, support, metrics, contacts, given: input.support };
};
export const views = async (aligner: Aligner, input: ViewsInput) => {
  const { views, world, uncertainty, diagnostics } = await aligner.alignViews(input);
  return { views, world, uncertainty, diagnostics, cameras: views.map(({ camera, role }) => ({ camera, role })) };
};
export const tracked = async (tracker: Tracker) =>
  [await tracker.next({} as never), await tracker.correct({} as never)] as const;
export const evaluated = async (aligner: Aligner, input: AlignInput) => {
  const { errors, diagnostics } = await aligner.evaluate(input, {} as never);
  return { errors, diagnostics };
};
export const registered = async (aligner: Aligner) => {
  const { diagnostics } = await aligner.register(mesh.positions, mesh.positions);
  return { diagnostics, counts: diagnostics.counts };
};
export const converted = (transform: Awaited<ReturnType<typeof aligned>>["result"]) => {
  const box = orientedBoundingBox(mesh, transform);
  const { entry } = toBop(transform);
  const [layout, straight] = [toSam3d(transform), uprightMesh(mesh, transform)];
  return { sam3d: generatorFrames.sam3d, layout, box, cuboid: toCuboid(box), entry, back: fromBop(entry), straight };
};
export const images = { rle: fromRle({} as never), cropped: cropInput, corrected: correctDepth };
