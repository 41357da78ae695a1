/** Scenes that a host gives to the element as files, as an archive, or by an address. */

import { extractArchives } from "../input/archives.js";
import { fromFile } from "../input/files.js";
import { readInputs, sceneOf } from "../input/reading.js";
import { rolesOf } from "../intake/file-roles.js";
import { scenesOf } from "../intake/grouping.js";
import { filesAt } from "../opening/case-url.js";
import { isSession, type Packed, sessionParts, unpacked } from "../session/pack.js";
import type { Inputs, NamedFile } from "../state/inputs.js";
import type { Scene } from "../state/scene.js";

/** A scene that can be shown, and what was done with it before. */
export interface Opened {
  scene: Scene;
  inputs: Inputs;
  session: Packed | null;
}

/** Reads files of a host. */
export async function readFiles(given: string | Blob | readonly unknown[]): Promise<Opened> {
  if (typeof given === "string") return fromFiles(await filesAt(given));
  if (given instanceof Blob) return fromFiles([fromFile(asFile(given))]);
  return fromFiles(given.map((file) => fromFile(file as File)));
}

const asFile = (blob: Blob) => (blob instanceof File ? blob : new File([blob], "case.zip"));

/** The first scene of files, which may be a project. */
async function fromFiles(files: readonly NamedFile[]): Promise<Opened> {
  const extracted = await extractArchives(files);
  const session = extracted.find(isSession);
  const parts = session === undefined ? null : await sessionParts(extracted, session);
  const inputs = parts === null ? scenesOf(rolesOf(extracted))[0] : (unpacked(parts.session, parts.files) ?? undefined);
  if (inputs === undefined) throw new Error("The files contain no scene that this version can open.");
  const reading = await readInputs(inputs);
  const [problem] = reading.problems;
  if (problem !== undefined) throw new Error(`${problem.field}: ${problem.message}`);
  const scene = sceneOf(inputs, reading);
  if (scene === null) {
    throw new Error("The files lack a part: a scene has a depth map, a camera, and a mask and a mesh per object.");
  }
  return { scene, inputs, session: parts?.session ?? null };
}
