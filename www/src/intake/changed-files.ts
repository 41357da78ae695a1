/** The inputs of a scene with other files in place of some of its own. */
import { baseName } from "../input/files.js";
import { OWN_FILES, titleOf } from "../input/names.js";
import type { Inputs, MeshSource, ObjectFiles, Role, Typed } from "../state/inputs.js";
import { scenesOf } from "./grouping.js";

/** What can be put into a scene that is there: all but its depth map, with which a new scene begins. */
const replaceable: readonly Role[] = ["photo", "camera", "mask", "mesh", "resource", "truth"];

/** Whether files can be put into a scene that is there. */
export const canReplace = (typed: readonly Typed[]): boolean =>
  typed.some(({ role }) => role !== "resource" && replaceable.includes(role)) &&
  typed.every(({ role }) => role === "unused" || replaceable.includes(role));

/** The files with others in place of those of the same role and name; there is one photo, and one camera. */
export function replaced(before: readonly Typed[], typed: readonly Typed[]): Typed[] {
  const gone = typed.flatMap(({ file: { path }, role }) => {
    const alike = before.filter((one) => one.role === role);
    if (role === "photo" || role === "camera") return alike;
    const namesakes = alike.filter(({ file }) => baseName(file.path) === baseName(path));
    const same = namesakes.find(({ file }) => file.path === path);
    return same === undefined && namesakes.length > 1 ? [] : [same ?? namesakes[0]];
  });
  return [...before.filter((one) => !gone.includes(one)), ...typed];
}

/** The scene of other files. What was entered stays, and so do pairs of files that are still there. */
export function rebuilt(before: Inputs, files: readonly Typed[]): Inputs {
  const [after] = scenesOf(files);
  if (after === undefined) return before;
  const { depthScale, depthKind, resizeMasks } = before;
  const camera = before.camera?.kind === "file" ? after.camera : (after.camera ?? before.camera);
  const paired = new Set<MeshSource>();
  const objects = after.objects.map((object) => {
    const known = before.objects.find(({ mask, mesh }) =>
      mask === null ? mesh !== null && mesh.file === object.mesh?.file : mask.file === object.mask?.file,
    );
    if (known === undefined) return object;
    const mesh = after.meshes.find(({ file }) => file === known.mesh?.file) ?? object.mesh;
    if (mesh !== null) paired.add(mesh);
    // That of a mesh alone is a guess, unless somebody has typed it.
    const isTyped = known.mask !== null || known.name !== titleOf(mesh?.file.path ?? "");
    return { ...object, name: isTyped ? known.name : object.name, mask: known.mask ?? object.mask, mesh };
  });
  // A mesh of which a pair is kept is that of no other object.
  const isTaken = ({ mask, mesh }: ObjectFiles) => mesh !== null && paired.has(mesh) && mask === null;
  return {
    ...after,
    ...{ id: before.id, imageId: before.imageId ?? after.imageId, objects: objects.filter((one) => !isTaken(one)) },
    ...{ depthScale, depthKind, resizeMasks, camera, ...ownName(before) },
  };
}

/** A sample with other files is no sample. */
export const ownName = ({ sample, name }: Inputs) => ({ sample: null, name: sample === null ? name : OWN_FILES });

/** The files of inputs with their roles, also of a sample. */
export function filesOf(inputs: Inputs): Typed[] {
  if (inputs.files.length > 0) return [...inputs.files];
  const typed: (Typed | null)[] = [
    inputs.depth && { file: inputs.depth, role: "depth" },
    inputs.photo && { file: inputs.photo, role: "photo" },
    inputs.camera?.kind === "file" ? { file: inputs.camera.file, role: "camera" } : null,
    ...inputs.objects.flatMap(({ mask, mesh, truth }): (Typed | null)[] => [
      mask && { file: mask.file, role: "mask" },
      mesh && { file: mesh.file, role: "mesh" },
      truth && { file: truth, role: "truth" },
    ]),
  ];
  return typed.filter((one) => one !== null);
}
