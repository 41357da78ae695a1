/** The samples that come with the page. */
import { type Inputs, noInputs } from "./inputs.js";
import type { NamedFile } from "./named-file.js";

/** A sample as it was made; paths are below `samples/`. */
export interface Sample {
  id: string;
  title: string;
  /** What it shows. */
  about: string;
  depth: string;
  camera: string;
  objects: readonly { id: string; title: string; mask: string; mesh: string; truth: string }[];
}

/** Written in by the build. */
declare const SAMPLES: readonly Sample[];

export const samples: readonly Sample[] = SAMPLES;

export const sampleOf = (id: string | null): Sample | undefined => samples.find((sample) => sample.id === id);

/** A file of a sample, which is on its way from now on. */
function fetched(path: string, title?: string): NamedFile {
  const content = fetch(new URL(`samples/${path}`, document.baseURI)).then(async (response) => {
    if (!response.ok) throw new Error(`${path} could not be loaded: ${response.status} ${response.statusText}.`);
    return new Uint8Array(await response.arrayBuffer());
  });
  // Whoever reads it will say what went wrong.
  content.catch(() => {});
  return { path, bytes: () => content, ...(title === undefined ? {} : { title }) };
}

/** A sample's inputs. */
export function sampleInputs({ id, title, depth, camera, objects }: Sample): Inputs {
  return {
    ...noInputs,
    name: title,
    sample: id,
    depth: fetched(depth),
    camera: { kind: "file", file: fetched(camera) },
    masks: objects.map(({ mask, title }) => fetched(mask, title)),
    meshes: objects.map(({ mesh }) => ({ file: fetched(mesh), beside: [] })),
    truths: objects.map(({ truth }) => fetched(truth)),
  };
}
