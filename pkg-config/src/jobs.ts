/** Calls as data, so that the same code runs them on the calling thread or in a worker. */
import { checkAttached } from "./attached.js";
import type { Core, CoreListener } from "./core.js";
import { withoutInput } from "./error.js";
import type { LoadFormats } from "./formats-module.js";
import type { Alignment } from "./generated/types.js";
import type { CoreInput } from "./input/core-input.js";
import { type MeshAndWarnings, readMesh } from "./input/mesh.js";
import { resolveInput } from "./input/resolve.js";
import type { AlignInput, MeshInput } from "./input/types.js";
import type { LoadRegistrar } from "./registration-module.js";
import { type AlignResult, type Clouds, type Evaluation, type Registration, withWarnings } from "./results.js";
import { isTypedArray, wrongKind } from "./values.js";
import type { LoadedModule } from "./wasm-module.js";

/** A call. `data` contains all large arrays; `options` are in the form of the core. */
export type Job =
  | { method: "align"; data: AlignInput; options: object; meshId?: number | undefined }
  | { method: "evaluate"; data: AlignInput; options: object; transform: unknown; meshId?: number | undefined }
  | { method: "prepareMesh"; data: { mesh: MeshInput }; options: object; meshId: number }
  | { method: "register"; data: Clouds; options: object }
  | { method: "estimateSim3"; data: Clouds; options: object };

/** The result of each call. */
export interface Results {
  align: AlignResult;
  evaluate: Evaluation;
  prepareMesh: MeshAndWarnings;
  register: Registration;
  estimateSim3: Registration;
}

/** The modules that run a job. */
export interface JobModules {
  core: LoadedModule<Core>;
  formats: LoadFormats;
  registrar: LoadRegistrar;
  /** Overrides the alignment by a single call of the core. */
  align?: (input: CoreInput, options: object, listener?: CoreListener) => Promise<Alignment>;
}

/** Whether these are options of `align` for the method of the paper, which the registration module runs. */
export const isOfPaper = (options: { preset?: unknown }): boolean => options.preset === "paper";

/** Runs a job. `listener` is called when stages begin; if it throws, the job fails with that exception. */
export async function perform<J extends Job>(
  job: J,
  modules: JobModules,
  listener?: CoreListener,
): Promise<Results[J["method"]]>;
export async function perform(
  job: Job,
  { core, formats, registrar, align }: JobModules,
  listener?: CoreListener,
): Promise<unknown> {
  const { options } = job;
  checkAttached("input", job.data);
  switch (job.method) {
    case "align": {
      const { core: input, warnings } = await resolveInput(job.data, formats, job.meshId);
      if (isOfPaper(options)) {
        const module = await registrar();
        checkAttached("input", input);
        return withWarnings(
          module.call((m) => m.alignPaper(input, options, listener), withoutInput),
          warnings,
        );
      }
      const result = await (align === undefined
        ? core.call((c) => c.align(input, options, listener), withoutInput)
        : align(input, options, listener));
      return withWarnings(result, warnings);
    }
    case "evaluate": {
      const { core: input, warnings } = await resolveInput(job.data, formats, job.meshId);
      // Files are read while the thread does other work, which may take the memory away.
      checkAttached("input", input);
      return withWarnings(
        core.call((c) => c.evaluate(input, job.transform, options), withoutInput),
        warnings,
      );
    }
    case "prepareMesh": {
      const { mesh, warnings } = await readMesh(job.data.mesh, formats, true);
      checkAttached("mesh", mesh);
      core.call((c) => c.prepareMesh({ ...mesh, id: job.meshId }));
      return { mesh, warnings };
    }
    case "register": {
      const { source, target } = checkedClouds(job.data);
      const module = await registrar();
      checkAttached("input", job.data);
      return module.call((m) => m.register(source, target, options));
    }
    case "estimateSim3": {
      const { source, target, correspondences } = checkedClouds(job.data);
      if (!isTypedArray<Uint32Array>(correspondences, "Uint32Array")) {
        throw wrongKind("correspondences", correspondences, "a Uint32Array of index pairs", "Uint32Array");
      }
      const module = await registrar();
      checkAttached("input", job.data);
      return module.call((m) => m.estimateSim3(source, target, correspondences, options));
    }
  }
}

function checkedClouds(clouds: Clouds): Clouds {
  for (const argument of ["source", "target"] as const) {
    const cloud: unknown = clouds[argument];
    if (isTypedArray(cloud, "Float32Array", "Float64Array")) continue;
    throw wrongKind(argument, cloud, "a Float32Array or a Float64Array, x, y, z per point", "Float64Array");
  }
  return clouds;
}
