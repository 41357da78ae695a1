/** Puts dropped files into inputs in place of those that they name. */
import { baseName } from "../input/files.js";
import { paired } from "../input/pairing.js";
import type { Inputs, NamedFile, ObjectFiles, Role, Typed } from "../state/inputs.js";
import { scenesOfTyped } from "./scenes.js";

/** What can be replaced in a scene that is there: all but its depth map, with which a new scene begins. */
const replaceable: readonly Role[] = ["photo", "camera", "mask", "mesh", "labels", "annotations", "resource", "truth"];

/** Whether files can be put into a scene that is there. */
export const canReplace = (typed: readonly Typed[]): boolean =>
  typed.some(({ role }) => role !== "resource" && replaceable.includes(role)) &&
  typed.every(({ role }) => role === "unused" || replaceable.includes(role));

/**
 * The inputs with these files: the photo, the camera, and the masks and meshes of the objects that they name. Masks and
 * meshes that name no object are objects of their own.
 */
export async function replaced(inputs: Inputs, typed: readonly Typed[]): Promise<Inputs> {
  const fileOf = (role: Role) => typed.find((one) => one.role === role)?.file;
  const [photo = inputs.photo, camera] = [fileOf("photo"), fileOf("camera")];
  const [added] = await scenesOfTyped(typed);
  if (added === undefined) return inputs;
  const objects = [...inputs.objects];
  const fresh: ObjectFiles[] = [];
  for (const own of added.objects) {
    const at = objectOf(inputs.objects, own);
    const object = objects[at];
    if (object === undefined) fresh.push(own);
    // The true pose is that of the mesh.
    else if (own.mesh === null) objects[at] = { ...object, mask: own.mask, isSure: true };
    else objects[at] = { ...object, mask: own.mask ?? object.mask, mesh: own.mesh, truth: own.truth, isSure: true };
  }
  const all = [...objects, ...fresh];
  const before = new Set(inputs.objects.flatMap(filesOf));
  const after = new Set(all.flatMap(filesOf));
  const isGone = (file: NamedFile) => before.has(file) && !after.has(file);
  const isOther = ({ file, role }: Typed) =>
    !isGone(file) && !(role === "photo" && file !== photo) && !(role === "camera" && camera !== undefined);
  return {
    ...inputs,
    photo,
    camera: camera === undefined ? inputs.camera : { kind: "file", file: camera },
    objects: all,
    meshes: [...inputs.meshes.filter(({ file }) => !isGone(file)), ...added.meshes],
    files: [...inputs.files.filter(isOther), ...typed],
  };
}

const filesOf = ({ mask, mesh, truth }: ObjectFiles): NamedFile[] =>
  [mask, mesh, truth].flatMap((source) => (source === null ? [] : [source.file]));

/** The index of the object that the files of another one name; -1 for none. */
function objectOf(objects: readonly ObjectFiles[], { mask, mesh }: ObjectFiles): number {
  if (objects.length === 1) return 0;
  const isNamed = (object: ObjectFiles) =>
    (mask !== null && baseName(object.mask?.file.path ?? "") === baseName(mask.file.path)) ||
    (mesh !== null && baseName(object.mesh?.file.path ?? "") === baseName(mesh.file.path));
  const named = objects.filter(isNamed);
  if (named.length === 1) return objects.indexOf(named[0] as ObjectFiles);
  const path = (mask ?? mesh)?.file.path ?? "";
  const found = paired(
    [path],
    objects.map(({ name }) => name),
  )[0];
  return found?.isSure === true ? (found.mesh ?? -1) : -1;
}
