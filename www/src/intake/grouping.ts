/** Groups the files of a drop by scenes, one depth map each, and the files of a scene by objects. */
import { ofDepthCamera } from "sim3align/case-names";
import { naturally } from "sim3align/values/order";
import { baseName, folderOf, stem } from "../input/files.js";
import { keyOf, OWN_FILES, titleOf } from "../input/names.js";
import {
  type Inputs,
  type MeshSource,
  type NamedFile,
  noInputs,
  type ObjectFiles,
  type Role,
  type Typed,
} from "../state/inputs.js";
import { isNamedPhoto } from "./file-roles.js";

/** The scenes of files; at least one, which lacks what the files lack. */
export function scenesOf(typed: readonly Typed[]): Inputs[] {
  const groups = grouped(typed);
  return groups.map(({ files, id }) => {
    const scene = sceneOf(files, id);
    // Images of one folder differ by their numbers.
    return groups.length > 1 && id !== null ? { ...scene, name: `${scene.name} ${id}` } : scene;
  });
}

interface Group {
  files: readonly Typed[];
  /** The number of the image, which files that describe several ones refer to. */
  id: string | null;
}

function grouped(typed: readonly Typed[]): Group[] {
  const depths = typed.filter(({ role }) => role === "depth").sort((a, b) => naturally(a.file.path, b.file.path));
  const idOf = ({ file }: Typed) => /(\d+)\D*$/.exec(stem(file.path))?.[1] ?? null;
  const [first, second] = depths;
  if (first === undefined || second === undefined)
    return [{ files: typed, id: first === undefined ? null : idOf(first) }];
  const folders = [...new Set(depths.map(({ file }) => folderOf(file.path)))];
  if (folders.length === 1) {
    const ids = depths.map(idOf);
    return depths.map((depth, i) => ({
      files: typed.filter((one) => one === depth || isOfImage(one, ids, i)),
      id: ids[i] ?? null,
    }));
  }
  const isInside = (folder: string, { file }: Typed) => file.path.startsWith(folder);
  const shared = typed.filter((one) => !folders.some((folder) => isInside(folder, one)));
  return folders.map((folder) => ({ files: [...typed.filter((one) => isInside(folder, one)), ...shared], id: null }));
}

/** Roles of files that may belong to several images of a folder. */
const sharedRoles: readonly Role[] = ["mesh", "camera", "truth", "resource"];

/** Whether a file belongs to the image with index `i`, by the first number in its name, or to all. */
function isOfImage({ file, role }: Typed, ids: readonly (string | null)[], i: number): boolean {
  if (role === "depth" || sharedRoles.includes(role)) return role !== "depth";
  const number = /\d+/.exec(stem(file.path))?.[0];
  return number === undefined || !ids.includes(number) || number === ids[i];
}

const byPath = (files: readonly NamedFile[]) => [...files].sort((a, b) => naturally(a.path, b.path));

function sceneOf(files: readonly Typed[], id: string | null): Inputs {
  const of = (role: Role) => byPath(files.filter((one) => one.role === role).map(({ file }) => file));
  const [[depth = null], photos] = [of("depth"), of("photo")];
  const [camera] = ofDepthCamera(of("camera"), ({ path }) => baseName(path));
  const meshes = of("mesh").map((file) => ({ file, siblings: files.map((one) => one.file) }));
  return {
    ...noInputs,
    name: nameOf(depth ?? files[0]?.file) || (meshes.length === 1 && titleOf(meshes[0]?.file.path ?? "")) || OWN_FILES,
    depth,
    photo: photos.find(isNamedPhoto) ?? photos[0] ?? null,
    camera: camera === undefined ? null : { kind: "file", file: camera },
    imageId: id,
    objects: objectsOf({ masks: of("mask"), meshes, truths: of("truth"), initials: of("initial") }, id),
    meshes,
    files,
  };
}

/** The name of the folder of a file; that of depth maps alone says nothing. */
function nameOf(file: NamedFile | undefined): string {
  const [, folder = "", above] = file?.path.split("/").reverse() ?? [];
  return (/^depth$/i.test(folder) ? above : folder) || "";
}

interface OfObjects {
  masks: readonly NamedFile[];
  meshes: readonly MeshSource[];
  truths: readonly NamedFile[];
  initials: readonly NamedFile[];
}

function objectsOf({ masks, meshes, truths, initials }: OfObjects, id: string | null): ObjectFiles[] {
  const meshOf = paired(masks, meshes, id);
  const objects = masks.map((file, i): ObjectFiles => {
    const mesh = meshOf.get(file) ?? null;
    const initial = initials.find(({ path }) => folderOf(path) === folderOf(file.path));
    return {
      name: objectName(file.path, mesh, masks.length, i),
      mask: { file },
      mesh,
      truth: partner(file, truths, id) ?? (masks.length === 1 ? (truths[0] ?? null) : null),
      ...(initial && { initial }),
    };
  });
  // A mesh alone still shows what is missing.
  const rest = meshes.filter((mesh) => !objects.some((object) => object.mesh === mesh));
  const alone = rest.map((mesh, i) => {
    const name = objectName(mesh.file.path, mesh, meshes.length, i);
    return { name, mask: null, mesh, truth: null };
  });
  return [...objects, ...alone];
}

/** The only file with the name of another one or, without any, in its folder. The number of the image is no name. */
function partner(file: NamedFile, others: readonly NamedFile[], id: string | null): NamedFile | null {
  const named = others.filter(({ path }) => keyOf(path, id) === keyOf(file.path, id));
  const near = others.filter(({ path }) => folderOf(path) === folderOf(file.path));
  return [named, near].find(({ length }) => length === 1)?.[0] ?? null;
}

/** Pairs masks with meshes: by name, by folder, or because only one of each is left. What is left over is asked for. */
function paired(masks: readonly NamedFile[], meshes: readonly MeshSource[], id: string | null) {
  const pairs = new Map<NamedFile, MeshSource>();
  const files = meshes.map(({ file }) => file);
  for (const mask of masks) {
    const found = partner(mask, files, id);
    const mesh = meshes.find(({ file }) => file === found);
    if (found !== null && mesh !== undefined && partner(found, masks, id) === mask) pairs.set(mask, mesh);
  }
  const taken = [...pairs.values()];
  const [openMask, ...otherMasks] = masks.filter((mask) => !pairs.has(mask));
  const [openMesh, ...otherMeshes] = meshes.filter((mesh) => !taken.includes(mesh));
  const isOnly = otherMasks.length === 0 && otherMeshes.length === 0;
  if (openMask !== undefined && openMesh !== undefined && isOnly) pairs.set(openMask, openMesh);
  return pairs;
}

/** The name of an object from the path of its mask, or of its mesh where that is only a number. */
function objectName(path: string, mesh: MeshSource | null, count: number, i: number): string {
  const words = titleOf(path);
  const others = mesh === null ? "" : titleOf(mesh.file.path);
  const hasLetters = (text: string) => /\p{L}/u.test(text);
  const name = hasLetters(words) ? words : hasLetters(others) ? others : words;
  const number = name.match(/\d+/g)?.at(-1);
  if (!hasLetters(name) && count > 1) return `Object ${number === undefined ? i + 1 : Number(number)}`;
  return name || "Object";
}
