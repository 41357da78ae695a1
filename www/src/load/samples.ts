/** The samples that come with the page. */
import { assigned, type Inputs, noInputs } from "./inputs.js";
import type { NamedFile } from "./named-file.js";

/** File names by sample; written in by the build. */
declare const SAMPLE_FILES: Readonly<Record<string, readonly string[]>>;

/** A sample. */
export interface Sample {
  id: string;
  title: string;
  /** What it shows. */
  about: string;
}

const known: readonly Sample[] = [
  { id: "mug", title: "Mug", about: "A mug, seen from one side." },
  { id: "hammer", title: "Hammer", about: "Long, with a small head." },
  { id: "spoon", title: "Spoon", about: "Thin: few readings, mostly at its edges." },
  { id: "occluded", title: "Behind something", about: "Something stands before the object, and hides part of it." },
  { id: "table", title: "Several on a table", about: "Three objects in one depth map." },
];

/** Those that were built with the page. */
export const samples: readonly Sample[] = Object.keys(SAMPLE_FILES)
  .map((id) => known.find((sample) => sample.id === id) ?? { id, title: id, about: "" })
  .sort((a, b) => known.indexOf(a) - known.indexOf(b));

export const sampleOf = (id: string | null): Sample | undefined => samples.find((sample) => sample.id === id);

const folder = (id: string) => new URL(`samples/${id}/`, document.baseURI);

/** A sample's inputs; its files are on their way. */
export function sampleInputs(sample: Sample): Inputs {
  const files = (SAMPLE_FILES[sample.id] ?? []).map((path): NamedFile => {
    const content = fetch(new URL(path, folder(sample.id))).then(async (response) => {
      if (!response.ok) throw new Error(`${path} could not be loaded: ${response.status} ${response.statusText}.`);
      return new Uint8Array(await response.arrayBuffer());
    });
    // Whoever reads it will say what went wrong.
    content.catch(() => {});
    return { path, bytes: () => content };
  });
  return { ...assigned(files, noInputs, sample.title), sample: sample.id };
}
