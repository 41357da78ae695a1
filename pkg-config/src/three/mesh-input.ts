/** Meshes from three.js objects. */

import { cofactors, determinant, type Matrix3, matrixOf as matrix3Of, turned } from "../conventions/rotation.js";
import type { MeshArrays } from "../types/inputs.js";
import { describe, failure } from "../values/error.js";
import { withForeignObject } from "../values/foreign-objects.js";
import { finiteNumbers, oneOf, optionsOf, whole } from "../values/validation.js";
import { surfaceSamples } from "./surface-samples.js";
import { type Texels, texelsOf } from "./texels.js";
import {
  type AttributeLike,
  type Fields,
  type GeometryLike,
  isObject,
  type MeshTree,
  type PlacedObject,
  type Range,
} from "./types.js";

/** The triangles so far, and the colours of the vertices: linear red, green and blue. */
interface Arrays {
  positions: number[];
  indices: number[];
  colors: number[];
  /** Whether any part has a colour other than white. */
  isColored: boolean;
  /** Whether any part has several materials, or a texture that cannot be read. */
  isUnknown: boolean;
  /** The parts with a texture, in the order of their triangles. */
  textured: TexturedPart[];
}

/** Consecutive triangles with one texture. */
interface TexturedPart {
  firstTriangle: number;
  endTriangle: number;
  firstVertex: number;
  coordinates: AttributeLike;
  texels: Texels;
}

/** A mesh of three.js as arrays. */
export interface ThreeMesh extends MeshArrays {
  positions: Float32Array;
  indices: Uint32Array;
  /** Why the colours cannot be read. */
  warnings?: string[];
}

const unreadable =
  "The mesh is read without its colours: it has several materials, or a texture that is not loaded, compressed, of another origin, or an image outside browsers. Pass the bytes of its file.";

/** A 4×4 matrix, column-major. */
type Matrix4 = readonly number[];

const identity: Matrix4 = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/**
 * The triangles of a three.js geometry, or of an object and its descendants, as three.js draws them, as a mesh for `align`. The
 * matrices of descendants and instances are applied, and so are bones, morph targets and the `drawRange` of geometries. What is
 * not `visible` is left out, but for the object itself; of an `LOD`, the first level counts.
 *
 * Its colours are those of vertices times those of materials, instances and of their `map`, for use with a photo. A mesh has none
 * if it has several materials, or a `map` that cannot be read: not loaded, compressed, of another origin, or an image outside
 * browsers (a `DataTexture` can be read anywhere). Then `warnings` says so, of which `align` makes `COLORS_NOT_READ`. Pass the
 * bytes of the file instead.
 *
 * @param source a `BufferGeometry`, or an `Object3D` such as a `Mesh`, a `Group` or a loaded scene
 * @param options `frame`: "object", the default, is the local frame of the object, before its position, quaternion and
 * scale, which `applyToObject3D` sets; "world" applies these and those of its parents
 * @returns interleaved x, y, z in the chosen frame, three indices per triangle, and `colors`, or `samples` if there is a
 * texture
 *
 * @example
 * const mesh = meshInputFromThree(gltf.scene);
 * @throws {@link Sim3AlignError} `EMPTY_MESH` if there is no triangle; `UNSUPPORTED_FORMAT` for what moves vertices in other ways: a
 * `BatchedMesh`, an `InstancedBufferGeometry`, a `displacementMap`, and morph targets of instances
 */
export function meshInputFromThree(
  source: GeometryLike | MeshTree,
  options: { frame?: "object" | "world" | undefined } = {},
): ThreeMesh {
  return withForeignObject("source", "a BufferGeometry or an Object3D", () => meshOf(source, options));
}

function meshOf(source: GeometryLike | MeshTree, options: { frame?: "object" | "world" | undefined }): ThreeMesh {
  const { frame = "object" } = optionsOf(options, ["frame"]);
  oneOf("options.frame", frame, ["object", "world"]);
  const arrays: Arrays = { positions: [], indices: [], colors: [], isColored: false, isUnknown: false, textured: [] };
  if (isGeometry(source)) append(arrays, source, identity, { material: { vertexColors: true } });
  else if (isTree(source)) appendTree(arrays, source, frame);
  else {
    const remedy = "Pass a geometry, a mesh, or a loaded scene.";
    throw failure("INVALID_ARGUMENT", "source", describe(source), "a BufferGeometry or an Object3D", remedy);
  }
  if (arrays.indices.length === 0) {
    const remedy = "Pass an object that contains meshes which are drawn.";
    throw failure("EMPTY_MESH", "source", "no triangle", "a mesh with triangles", remedy);
  }
  const mesh = { positions: Float32Array.from(arrays.positions), indices: Uint32Array.from(arrays.indices) };
  if (arrays.isUnknown) return { ...mesh, warnings: [unreadable] };
  if (!arrays.isColored) return mesh;
  if (arrays.textured.length > 0) return { ...mesh, samples: texturedSamples(mesh, arrays) };
  return { ...mesh, colors: Float32Array.from(arrays.colors), colorSpace: "linear" };
}

/** Most vertices, corners and instances of one object. */
const MOST = 1 << 26;

/** A number of items, which ends the loop over them. */
function countOf(argument: string, value: unknown): number {
  const count = whole(argument, value, 0);
  if (count <= MOST) return count;
  throw failure("INVALID_ARGUMENT", argument, describe(value), `at most ${MOST}`, "Split the object.");
}

const isGeometry = (value: unknown): value is GeometryLike => isObject(value) && isObject(value.attributes);
const isTree = (value: unknown): value is MeshTree => isObject(value) && typeof value.traverse === "function";

type Found = PlacedObject & Fields;

function appendTree(arrays: Arrays, tree: MeshTree, frame: "object" | "world") {
  tree.updateWorldMatrix(true, true);
  const base = frame === "world" ? identity : inverse(matrixOf(tree.matrixWorld.elements));
  const hidden = new Set<unknown>();
  tree.traverse((object) => {
    const found = object as Found;
    // Parents come first.
    if (hidden.has(found.parent) || hidden.has(found)) return hidden.add(found);
    if (found.visible === false && found !== (tree as unknown) && !isFirstLevel(found)) return hidden.add(found);
    for (const { object } of levelsOf(found).slice(1)) hidden.add(object);
    if (found.isMesh === true && isGeometry(found.geometry)) appendMesh(arrays, found, found.geometry, base);
    return undefined;
  });
}

/** The levels of an `LOD`, the finest first. */
const levelsOf = ({ isLOD, levels }: Fields): Fields[] => (isLOD === true && Array.isArray(levels) ? levels : []);

/** Whether an object is the finest level of an `LOD`, whatever the distance of the last camera. */
const isFirstLevel = (found: Found) => isObject(found.parent) && levelsOf(found.parent)[0]?.object === found;

function appendMesh(arrays: Arrays, found: Found, geometry: GeometryLike, base: Matrix4) {
  const isMorphed = Object.keys(geometry.morphAttributes ?? {}).includes("position");
  const isDisplaced = isObject(found.material) && isObject(found.material.displacementMap);
  const unsupported =
    (found.isBatchedMesh === true && "a BatchedMesh") ||
    (isObject(found.geometry) && found.geometry.isInstancedBufferGeometry === true && "an InstancedBufferGeometry") ||
    (isDisplaced && "a material with a displacementMap") ||
    (isMorphed && found.isInstancedMesh === true && "instances with morph targets");
  if (unsupported !== false) {
    const remedy = "Merge its geometries, or pass them individually, as they are drawn.";
    throw failure("UNSUPPORTED_FORMAT", "source", unsupported, "meshes and instances", remedy);
  }
  if (found.isSkinnedMesh === true) updateBones(found);
  const local = product(base, matrixOf(found.matrixWorld.elements));
  const look = { material: found.material, vertexOf: found.isSkinnedMesh || isMorphed ? vertexOf(found) : undefined };
  if (found.isInstancedMesh !== true) return append(arrays, geometry, local, look);
  const { array } = found.instanceMatrix as { array: ArrayLike<number> };
  const colors = found.instanceColor as AttributeLike | null | undefined;
  for (let i = 0; i < countOf("source.count", found.count); i++) {
    const instance = Array.from({ length: 16 }, (_, k) => array[16 * i + k] ?? 0);
    const tint = colors ? ([colors.getX(i), colors.getY(i), colors.getZ(i)] as const) : undefined;
    append(arrays, geometry, product(local, instance), { ...look, tint });
  }
}

/** Brings what skins a mesh up to date, as rendering does: bones may be elsewhere in the scene. */
function updateBones(found: Found) {
  const { bones = [] } = (isObject(found.skeleton) ? found.skeleton : {}) as { bones?: PlacedObject[] };
  for (const bone of bones) bone.updateWorldMatrix(true, false);
  if (typeof found.updateMatrixWorld === "function") found.updateMatrixWorld(true);
}

/** The vertices of a mesh with morph targets and bones, in its local frame. */
function vertexOf(found: Found): (index: number) => readonly [number, number, number] {
  const { position, getVertexPosition } = found as { position?: unknown; getVertexPosition?: unknown };
  if (typeof getVertexPosition !== "function" || !isObject(position) || typeof position.clone !== "function") {
    const remedy = "Use three.js from r151 on, or pass the geometry in its pose.";
    throw failure("UNSUPPORTED_FORMAT", "source", "a mesh with bones or morph targets", "getVertexPosition()", remedy);
  }
  const vertex = position.clone() as { x: number; y: number; z: number };
  return (index) => {
    getVertexPosition.call(found, index, vertex);
    return [vertex.x, vertex.y, vertex.z];
  };
}

/** How a geometry looks: its material, where its vertices are if not where its attribute says, and the colour of the instance. */
interface Look {
  material: unknown;
  vertexOf?: ((index: number) => readonly [number, number, number]) | undefined;
  tint?: readonly [number, number, number] | undefined;
}

/** Adds the triangles of a geometry, transformed. */
function append(arrays: Arrays, geometry: GeometryLike, m: Matrix4, { material, vertexOf, tint }: Look) {
  const { attributes, index } = geometry;
  const position = attributes.position as AttributeLike | undefined;
  if (!position || typeof position.getX !== "function") return;
  const first = arrays.positions.length / 3;
  const [a = 0, b = 0, c = 0, , d = 0, e = 0, f = 0, , g = 0, h = 0, k = 0, , tx = 0, ty = 0, tz = 0] = m;
  const vertices = countOf("source.attributes.position.count", position.count);
  for (let i = 0; i < vertices; i++) {
    // The getters handle normalised and interleaved attributes.
    const [x, y, z] = vertexOf?.(i) ?? [position.getX(i), position.getY(i), position.getZ(i)];
    arrays.positions.push(a * x + d * y + g * z + tx, b * x + e * y + h * z + ty, c * x + f * y + k * z + tz);
  }
  appendColors(arrays, attributes.color as AttributeLike | undefined, position.count, material, tint);
  const firstTriangle = arrays.indices.length / 3;
  const corner = (i: number) => first + (index === null ? i : index.getX(i));
  const count = index === null ? vertices : countOf("source.index.count", index.count);
  const isMirrored = determinant(linearOf(m)) < 0;
  for (const [start, end] of drawn(geometry, material, count)) {
    // Reflections invert the orientation of triangles: swap two corners.
    for (let i = start; i + 2 < end; i += 3) {
      arrays.indices.push(corner(i), corner(i + (isMirrored ? 2 : 1)), corner(i + (isMirrored ? 1 : 2)));
    }
  }
  const part = { firstTriangle, endTriangle: arrays.indices.length / 3, firstVertex: first };
  appendTexture(arrays, attributes, part, material);
}

/** The ranges of a geometry's corners that are drawn: within `drawRange` and, with several materials, those of the groups. */
function drawn({ drawRange, groups }: GeometryLike, material: unknown, count: number): [start: number, end: number][] {
  const isShown = (one: unknown) => !(isObject(one) && one.visible === false);
  const within = (range: Range | undefined): [number, number] => [
    Math.max(0, range?.start ?? 0),
    Math.min(count, (range?.start ?? 0) + (range?.count ?? count)),
  ];
  const [first, end] = within(drawRange);
  if (!Array.isArray(material)) return isShown(material) ? [[first, end]] : [];
  const shown = (groups ?? []).filter(
    ({ materialIndex = 0 }) => material[materialIndex] && isShown(material[materialIndex]),
  );
  return shown.map(within).map(([from, to]) => [Math.max(first, from), Math.min(end, to)]);
}

/** The colour and the texture that a material shows: those that it emits if it is black, as materials without shading are. */
function shownBy(material: unknown): Fields {
  if (!isObject(material)) return {};
  const { color, emissive, emissiveMap } = material;
  const isBlack = (one: unknown) => isObject(one) && one.r === 0 && one.g === 0 && one.b === 0;
  return isBlack(color) && isObject(emissive) && !isBlack(emissive) ? { color: emissive, map: emissiveMap } : material;
}

/** Adds the texture of a material, if it has one. */
function appendTexture(
  arrays: Arrays,
  attributes: GeometryLike["attributes"],
  part: Pick<TexturedPart, "firstTriangle" | "endTriangle" | "firstVertex">,
  material: unknown,
): void {
  const { map } = shownBy(material);
  if (!isObject(map)) return;
  const coordinates = attributes[map.channel ? `uv${map.channel}` : "uv"] as AttributeLike | undefined;
  const texels = typeof coordinates?.getX === "function" ? texelsOf(map) : null;
  if (texels === null) arrays.isUnknown = true;
  else arrays.textured.push({ ...part, coordinates: coordinates as AttributeLike, texels });
  arrays.isColored = true;
}

/** The colours of a surface: those of vertices times those of textures. */
function texturedSamples(
  { positions, indices }: { positions: Float32Array; indices: Uint32Array },
  { colors, textured }: Arrays,
) {
  const texel = new Float64Array(3);
  let at = 0;
  // Triangles come in ascending order.
  return surfaceSamples(positions, indices, (triangle, second, third, out) => {
    const corners = [0, 1, 2].map((corner) => indices[3 * triangle + corner] as number);
    const mixed = (of: (vertex: number) => number) => {
      const [a = 0, b = 0, c = 0] = corners.map(of);
      return a + (b - a) * second + (c - a) * third;
    };
    for (let channel = 0; channel < 3; channel++) out[channel] = mixed((i) => colors[3 * i + channel] as number);
    while (at < textured.length - 1 && (textured[at] as TexturedPart).endTriangle <= triangle) at++;
    const { firstTriangle, endTriangle, firstVertex, coordinates, texels } = textured[at] as TexturedPart;
    if (triangle < firstTriangle || triangle >= endTriangle) return;
    const [u, v] = [mixed((i) => coordinates.getX(i - firstVertex)), mixed((i) => coordinates.getY(i - firstVertex))];
    texels.colorAt(u, v, texel);
    for (let channel = 0; channel < 3; channel++) {
      out[channel] = (out[channel] as number) * (texel[channel] as number);
    }
  });
}

/** Adds the colours of vertices: their attribute, if the material shows it, times the colour of the material. */
function appendColors(
  arrays: Arrays,
  attribute: AttributeLike | undefined,
  count: number,
  material: unknown,
  [red, green, blue]: readonly [number, number, number] = [1, 1, 1],
): void {
  const { color } = shownBy(material);
  const vertexColors = isObject(material) && material.vertexColors;
  if (Array.isArray(material)) arrays.isUnknown = true;
  const isShown = vertexColors === true && typeof attribute?.getX === "function" && attribute.count === count;
  const own = (isObject(color) ? color : {}) as { r?: number; g?: number; b?: number };
  const [r, g, b] = [red * (own.r ?? 1), green * (own.g ?? 1), blue * (own.b ?? 1)];
  if (isShown || r !== 1 || g !== 1 || b !== 1) arrays.isColored = true;
  for (let i = 0; i < count; i++) {
    const [x, y, z] = isShown ? [attribute.getX(i), attribute.getY(i), attribute.getZ(i)] : [1, 1, 1];
    arrays.colors.push(r * x, g * y, b * z);
  }
}

const matrixOf = (elements: unknown): Matrix4 =>
  finiteNumbers("source.matrixWorld", elements, 16, "a matrix of 16 finite numbers");

function product(a: Matrix4, b: Matrix4): Matrix4 {
  return Array.from({ length: 16 }, (_, i) => {
    const [row, column] = [i % 4, i - (i % 4)];
    return [0, 1, 2, 3].reduce((sum, k) => sum + (a[4 * k + row] ?? 0) * (b[column + k] ?? 0), 0);
  });
}

/** The linear part of an affine matrix. */
const linearOf = (m: Matrix4): Matrix3 => matrix3Of((row, column) => m[4 * column + row] ?? 0);

/** The inverse of an affine matrix. */
function inverse(m: Matrix4): Matrix4 {
  const linear = linearOf(m);
  const volume = determinant(linear);
  if (volume === 0 || !Number.isFinite(volume)) {
    const remedy = "Set the scales of the object and its parents to values other than 0.";
    throw failure("INVALID_TRANSFORM", "source.matrixWorld", "a singular matrix", "an invertible matrix", remedy);
  }
  // Rows of the cofactors are columns of the inverse.
  const [a, b, c, d, e, f, g, h, i] = cofactors(linear).map((minor) => minor / volume) as unknown as Matrix3;
  const [x, y, z] = turned([a, d, g, b, e, h, c, f, i], [m[12] ?? 0, m[13] ?? 0, m[14] ?? 0]);
  return [a, b, c, 0, d, e, f, 0, g, h, i, 0, -x, -y, -z, 1];
}
