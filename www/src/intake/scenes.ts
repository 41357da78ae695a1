/** Divides the files of a drop into scenes: one depth map each, with the files that belong to it. */
import { ofDepthCamera } from "sim3align/case-names";
import { naturally } from "sim3align/values/order";
import { baseName, folderOf, stem } from "../input/files.js";
import { annotationsOf, labelValues } from "../input/label-masks.js";
import { paired, titleOf, wordsOf } from "../input/pairing.js";
import {
  type Inputs,
  type MaskSource,
  type MeshSource,
  type NamedFile,
  noInputs,
  type ObjectFiles,
  type Role,
  type TruthSource,
  type Typed,
} from "../state/inputs.js";
import { isNamedPhoto } from "./roles.js";

/** The scenes of a drop; at least one, which lacks what the files lack. */
export async function scenesOfTyped(typed: readonly Typed[]): Promise<Inputs[]> {
  const groups = await grouped(typed);
  const isSeries = groups.length > 1;
  return Promise.all(
    groups.map(async ({ files, id }) => {
      const scene = await sceneFrom(files, id);
      // Images of one folder differ by their ids.
      return isSeries && id !== null ? { ...scene, name: `${scene.name} ${id}` } : scene;
    }),
  );
}

interface Group {
  files: readonly Typed[];
  /** The image in files that describe several, if known. */
  id: string | null;
}

async function grouped(typed: readonly Typed[]): Promise<Group[]> {
  const depths = typed.filter(({ role }) => role === "depth").sort((a, b) => naturally(a.file.path, b.file.path));
  const [first] = depths;
  if (first === undefined) return [{ files: typed, id: null }];
  const folders = new Set(depths.map(({ file }) => folderOf(file.path)));
  const idOf = ({ file }: Typed) => /(\d+)\D*$/.exec(stem(file.path))?.[1] ?? null;
  if (depths.length === 1) return [{ files: typed, id: idOf(first) }];
  if (folders.size === 1) {
    // Images of one folder, whose files begin with the id of their image: BOP, and most recordings.
    const ids = depths.map(idOf);
    return depths.map((depth, i) => ({
      files: typed.filter((one) => one === depth || isOfImage(one, ids, i)),
      id: ids[i] ?? null,
    }));
  }
  const roots = [...folders].map((folder) => ownFolder(folder, [...folders]));
  const inside = (root: string, { file }: Typed) => file.path.startsWith(root);
  const shared = typed.filter((one) => !roots.some((root) => inside(root, one)));
  const groups = roots.map((root) => ({ files: [...typed.filter((one) => inside(root, one)), ...shared], id: null }));
  return sameImage(groups);
}

/** Whether a file belongs to the image with index `i`, or to all. */
function isOfImage({ file, role }: Typed, ids: readonly (string | null)[], i: number): boolean {
  if (role === "depth") return false;
  if (role === "mesh" || role === "camera" || role === "truth" || role === "annotations" || role === "resource")
    return true;
  const numbers = stem(file.path).match(/\d+/g) ?? [];
  const same = (id: string | null) =>
    id !== null && numbers.some((number) => Number(number) === Number(id) && number.length === id.length);
  return ids.some(same) ? same(ids[i] ?? null) && numbers[0] === (ids[i] ?? null) : true;
}

/** The folder of a scene: that of its depth map, or the one above if it holds depth maps only. */
function ownFolder(folder: string, folders: readonly string[]): string {
  const parent = folderOf(folder.slice(0, -1));
  const isShared = parent === "" || folders.some((other) => other !== folder && other.startsWith(parent));
  return /(^|\/)depth\/$/i.test(folder) && !isShared ? parent : folder;
}

/** Case folders of the same image are one scene with several objects. */
async function sameImage(groups: readonly Group[]): Promise<Group[]> {
  const contents = await Promise.all(
    groups.map(async ({ files }) => files.find(({ role }) => role === "depth")?.file.bytes() ?? new Uint8Array()),
  );
  const merged: { bytes: Uint8Array; group: Group }[] = [];
  groups.forEach((group, i) => {
    const bytes = contents[i] as Uint8Array;
    const same = merged.find((other) => isEqual(other.bytes, bytes));
    if (same === undefined) merged.push({ bytes, group });
    else same.group = { id: null, files: [...same.group.files, ...group.files.filter(isOfObject)] };
  });
  return merged.map(({ group }) => group);
}

const ofObject: readonly Role[] = ["mask", "labels", "mesh", "truth", "resource"];
const isOfObject = ({ role }: Typed) => ofObject.includes(role);

const isEqual = (a: Uint8Array, b: Uint8Array) => a.length === b.length && a.every((byte, i) => byte === b[i]);

/** A mask with the name that it is paired by. */
interface NamedMask {
  source: MaskSource;
  /** A path, or the name of a category. */
  path: string;
}

async function sceneFrom(files: readonly Typed[], id: string | null): Promise<Inputs> {
  const of = (role: Role) => files.filter((one) => one.role === role).map(({ file }) => file);
  const [[depth = null], photos] = [of("depth"), of("photo")];
  const photo = photos.find(isNamedPhoto) ?? photos[0] ?? null;
  const [camera] = ofDepthCamera(of("camera"), ({ path }) => baseName(path));
  const meshes = byPath(of("mesh")).map((file) => ({ file, siblings: files.map((one) => one.file) }));
  const masks = await masksOf(files, depth, photo);
  const truths = byPath(of("truth"));
  return {
    ...noInputs,
    name: nameOf(files, depth),
    depth,
    photo,
    camera: camera === undefined ? null : { kind: "file", file: camera },
    imageId: id,
    objects: (await objectsOf(masks, meshes, truths, id)).map((object) => withInitial(object, of("initial"))),
    meshes,
    files,
  };
}

/** An object with the first pose beside its mask. */
function withInitial(object: ObjectFiles, initials: readonly NamedFile[]): ObjectFiles {
  const folder = folderOf(object.mask?.file.path ?? "");
  const initial = initials.find(({ path }) => folderOf(path) === folder);
  return initial === undefined ? object : { ...object, initial };
}

const byPath = (files: readonly NamedFile[]) => [...files].sort((a, b) => naturally(a.path, b.path));

function nameOf(files: readonly Typed[], depth: NamedFile | null): string {
  const parts = (depth ?? files[0]?.file)?.path.split("/") ?? [];
  const folder = parts.at(-2) ?? "";
  return (/^depth$/i.test(folder) ? parts.at(-3) : folder) || "Own files";
}

/** All masks of a scene. A single mask file with several values is a label map. */
async function masksOf(
  files: readonly Typed[],
  depth: NamedFile | null,
  photo: NamedFile | null,
): Promise<NamedMask[]> {
  const masks = byPath(files.flatMap(({ file, role }) => (role === "mask" ? [file] : [])));
  const maps = byPath(files.flatMap(({ file, role }) => (role === "labels" ? [file] : [])));
  const meshCount = files.filter(({ role }) => role === "mesh").length;
  const only = masks.length === 1 && maps.length === 0 && meshCount > 1 ? masks[0] : undefined;
  const named: NamedMask[] = [];
  for (const file of only === undefined ? maps : [only]) {
    const values = await labelValues(file).catch(() => []);
    if (values.length === 0) named.push({ source: { file }, path: file.path });
    for (const label of values) named.push({ source: { file, label }, path: `${label}` });
  }
  if (only === undefined) named.push(...masks.map((file) => ({ source: { file }, path: file.path })));
  const imageNames = [depth, photo].flatMap((file) => (file === null ? [] : [stem(file.path)]));
  for (const { file } of files.filter(({ role }) => role === "annotations")) {
    const found = await annotationsOf(file, imageNames).catch(() => []);
    named.push(
      ...found.map(({ index, name }) => ({ source: { file, annotation: index }, path: name || `${index + 1}` })),
    );
  }
  return named;
}

async function objectsOf(
  masks: readonly NamedMask[],
  meshes: readonly MeshSource[],
  truths: readonly NamedFile[],
  id: string | null,
): Promise<ObjectFiles[]> {
  const bop = await bopEntries(truths, id);
  const paths = meshes.map(({ file }) => file.path);
  const matches = paired(
    masks.map(({ path }) => path),
    paths,
  );
  const objects = masks.map(({ source, path }, i): ObjectFiles => {
    const entry = bop === null ? null : bopEntryOf(bop, path);
    const model = entry === null ? -1 : paths.findIndex((mesh) => modelNumber(mesh) === entry.model);
    const match = matches[i];
    const mesh = model >= 0 ? meshes[model] : match?.mesh == null ? undefined : meshes[match.mesh];
    const truth: TruthSource | undefined =
      entry !== null
        ? { file: (bop as Bop).file, entry: { imageId: (bop as Bop).imageId, index: entry.index } }
        : undefined;
    return {
      name: objectName(path, mesh, masks.length, i),
      mask: source,
      mesh: mesh ?? null,
      truth:
        truth ??
        truthOf(
          source,
          truths.filter((file) => file !== bop?.file),
          masks.length,
        ),
      isSure: model >= 0 || match?.isSure === true,
    };
  });
  const isFree = (mesh: MeshSource) => !objects.some((object) => object.mesh === mesh);
  // A mesh alone still shows what is missing. Of a BOP data set, most models are in other images.
  if (bop !== null) return objects;
  const rest = meshes.filter(isFree).map((mesh, i) => ({
    name: objectName(mesh.file.path, mesh, meshes.length, i),
    ...{ mask: null, mesh, truth: null, isSure: false },
  }));
  return [...objects, ...rest];
}

/** The name of an object from the path of its mask, or of its mesh where that is only a number. */
function objectName(path: string, mesh: MeshSource | undefined, count: number, i: number): string {
  const words = titleOf(path);
  const others = mesh === undefined ? "" : titleOf(mesh.file.path);
  const hasLetters = (text: string) => /\p{L}/u.test(text);
  const name = hasLetters(words) ? words : hasLetters(others) ? others : words;
  const number = name.match(/\d+/g)?.at(-1);
  if (!hasLetters(name) && count > 1) return `Object ${number === undefined ? i + 1 : Number(number)}`;
  return name || "Object";
}

/** The true pose beside a mask, or the only one for the only mask. */
function truthOf(mask: MaskSource, truths: readonly NamedFile[], count: number): TruthSource | null {
  const beside = truths.filter((file) => folderOf(file.path) === folderOf(mask.file.path));
  const key = (path: string) =>
    wordsOf(path)
      .filter((word) => !["gt", "truth"].includes(word))
      .join(" ");
  const found =
    beside.find((file) => key(file.path) === key(mask.file.path)) ??
    (beside.length === 1 || count === 1 ? beside[0] : undefined);
  return found === undefined ? null : { file: found };
}

/** The objects of an image in BOP's `scene_gt.json`: the number of the model of each. */
interface Bop {
  file: NamedFile;
  imageId: string;
  models: readonly number[];
}

async function bopEntries(truths: readonly NamedFile[], id: string | null): Promise<Bop | null> {
  const file = truths.find(({ path }) => baseName(path).startsWith("scene_gt"));
  if (file === undefined) return null;
  try {
    const images = JSON.parse(new TextDecoder().decode(await file.bytes())) as Record<string, { obj_id: number }[]>;
    const keys = Object.keys(images);
    const imageId =
      keys.find((key) => Number(key) === Number(id ?? Number.NaN)) ?? (keys.length === 1 ? keys[0] : undefined);
    if (imageId === undefined) return null;
    return { file, imageId, models: (images[imageId] ?? []).map(({ obj_id }) => obj_id) };
  } catch {
    // Poses only serve for comparison and pairing.
    return null;
  }
}

/** The entry of a mask such as 000003_000001.png: the second number is its index. */
function bopEntryOf({ models }: Bop, path: string): { index: number; model: number } | null {
  const number = /_(\d+)\.\w+$/.exec(path)?.[1];
  const index = number === undefined ? 0 : Number(number);
  const model = models[index];
  return model === undefined || (number === undefined && models.length > 1) ? null : { index, model };
}

const modelNumber = (path: string) => Number(/(\d+)\D*$/.exec(stem(path))?.[1] ?? Number.NaN);
