/** The samples of the page. */
import { type Inputs, type NamedFile, noInputs } from "../state/inputs.js";

/** A sample. Paths are relative to `samples/`. */
export interface Sample {
  id: string;
  title: string;
  /** One line about it. */
  about: string;
  depth: string;
  camera: string;
  photo?: string;
  /** A small picture of it. */
  picture: string;
  objects: readonly { id: string; title: string; mask: string; mesh: string; truth: string }[];
}

/** Replaced by the build. */
declare const SAMPLES: readonly Sample[];

export const samples: readonly Sample[] = SAMPLES;

export const sampleOf = (id: string | null): Sample | undefined => samples.find((sample) => sample.id === id);

/** The address of a file of a sample. */
export const sampleUrl = (path: string): string => new URL(`samples/${path}`, document.baseURI).href;

/** A file of a sample. The download starts at once. */
function fetched(path: string): NamedFile {
  const content = fetch(sampleUrl(path)).then(async (response) => {
    if (!response.ok) throw new Error(`${path} could not be loaded: HTTP ${response.status} ${response.statusText}.`);
    return new Uint8Array(await response.arrayBuffer());
  });
  // The reader of the file reports the error; without this line it would count as unhandled until then.
  content.catch(() => {});
  return { path, bytes: () => content };
}

/** The inputs of a sample. */
export function sampleInputs({ id, title, depth, camera, photo, objects }: Sample): Inputs {
  const made = objects.map(({ title, mask, mesh, truth }) => ({
    name: title,
    mask: { file: fetched(mask) },
    mesh: { file: fetched(mesh), siblings: [] },
    truth: fetched(truth),
  }));
  return {
    ...noInputs,
    name: title,
    sample: id,
    depth: fetched(depth),
    camera: { kind: "file", file: fetched(camera) },
    photo: photo === undefined ? null : fetched(photo),
    objects: made,
    meshes: made.map(({ mesh }) => mesh),
  };
}
