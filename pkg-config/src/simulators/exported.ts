/** The parts that the files for all simulators share: checked scenes, names, numbers and meshes. */
import { Names } from "../conventions/names.js";
import { type Matrix3, product, rotationOfUnit, transposed } from "../conventions/rotation.js";
import { invalidArgument } from "../values/error.js";
import { isTypedArray } from "../values/kinds.js";
import {
  finite,
  finiteNumbers,
  positive,
  type Quaternion,
  record,
  text,
  vector3,
  whole,
} from "../values/validation.js";
import type { ConvexPart, SimulatorBody, SimulatorPose, SimulatorScene } from "./scene.js";

/** A body, with the names of its parts. Its own name is that of its surface as well. */
export interface ExportedBody
  extends Pick<
      SimulatorBody,
      "name" | "found" | "isFixed" | "mass" | "centerOfMass" | "principalMoments" | "principalAxes"
    >,
    Pick<SimulatorBody, "mesh" | "color" | "inside">,
    SimulatorPose {
  parts: (ConvexPart & { name: string })[];
}

/** A scene whose names are all different. */
export interface ExportedScene extends Pick<SimulatorScene, "hasGround" | "camera"> {
  bodies: ExportedBody[];
}

/**
 * Reads a scene, which a caller may have changed or put together.
 * @throws {@link Sim3AlignError} for what is no scene
 */
export function exportedScene(scene: SimulatorScene): ExportedScene {
  const { bodies, hasGround, camera } = record("scene", scene, SCENE);
  const read = listOf("scene.bodies", bodies, bodyOf);
  for (const [i, { inside }] of read.entries()) {
    if (inside.every((k) => k < read.length)) continue;
    throw invalidArgument(`scene.bodies[${i}].inside`, inside, `indices below ${read.length}`, "Pass all bodies.");
  }
  const names = new Names();
  const named = read.map((body) => ({ ...body, name: names.own(body.name) }));
  const whole = named.map(({ parts, ...body }) => ({
    ...body,
    // After all bodies, whose names are more likely to be looked for.
    parts: parts.map((part, k) => ({ ...part, name: names.own(`${body.name}_${k}`) })),
  }));
  return { bodies: whole, hasGround: hasGround === true, camera: camera === null ? null : viewOf(camera) };
}

const SCENE = "the result of simulatorScene";

function listOf<T>(argument: string, value: unknown, read: (argument: string, item: unknown) => T): T[] {
  if (Array.isArray(value)) return value.map((item, i) => read(`${argument}[${i}]`, item));
  throw invalidArgument(argument, value, "an array", `Pass ${SCENE}.`);
}

function bodyOf(argument: string, value: unknown): Omit<ExportedBody, "parts"> & { parts: ConvexPart[] } {
  const body = record(argument, value, `a body of ${SCENE}`);
  const at = (name: string) => `${argument}.${name}`;
  return {
    ...poseOf(argument, body),
    name: text(at("name"), body.name),
    found: poseOf(at("found"), record(at("found"), body.found, "{ position, rotation }")),
    isFixed: body.isFixed === true,
    mass: finite(at("mass"), body.mass),
    centerOfMass: vector3(at("centerOfMass"), body.centerOfMass),
    principalMoments: vector3(at("principalMoments"), body.principalMoments),
    principalAxes: quaternion(at("principalAxes"), body.principalAxes),
    mesh: surfaceOf(at("mesh"), body.mesh) as SimulatorBody["mesh"],
    color: vector3(at("color"), body.color),
    inside: listOf(at("inside"), body.inside, (name, index) => whole(name, index, 0)),
    parts: listOf(at("parts"), body.parts, surfaceOf) as ConvexPart[],
  };
}

const quaternion = (argument: string, value: unknown) =>
  finiteNumbers(argument, value, 4, "a quaternion x, y, z, w") as Quaternion;

const poseOf = (argument: string, { position, rotation }: Record<string, unknown>): SimulatorPose => ({
  position: vector3(`${argument}.position`, position),
  rotation: quaternion(`${argument}.rotation`, rotation),
});

function surfaceOf(argument: string, value: unknown): { positions: ArrayLike<number>; indices: ArrayLike<number> } {
  const { positions, indices } = record(argument, value, "{ positions, indices }");
  if (!isTypedArray<Float64Array>(positions, "Float32Array", "Float64Array"))
    throw invalidArgument(`${argument}.positions`, positions, "a Float32Array or a Float64Array", `Pass ${SCENE}.`);
  if (!isTypedArray<Uint32Array>(indices, "Uint32Array"))
    throw invalidArgument(`${argument}.indices`, indices, "a Uint32Array", `Pass ${SCENE}.`);
  return { positions, indices };
}

function viewOf(value: unknown): ExportedScene["camera"] {
  const camera = record("scene.camera", value, `null, or the camera of ${SCENE}`);
  const number = (name: string) => positive(`scene.camera.${name}`, camera[name]);
  const center = (name: string) => finite(`scene.camera.${name}`, camera[name]);
  return {
    ...poseOf("scene.camera", camera),
    ...{ fovYDeg: number("fovYDeg"), width: number("width"), height: number("height") },
    ...{ fx: number("fx"), fy: number("fy"), cx: center("cx"), cy: center("cy") },
  };
}

/** The mark of files that this package writes. */
export const GENERATOR = "written by sim3align";

/** A number with seven digits. */
const short = (x: number) => String(Number(x.toPrecision(7)));

/** Numbers with spaces between them. */
export const spaced = (numbers: ArrayLike<number>): string => Array.from(numbers, short).join(" ");

/** The meshes of bodies as files by their paths, in `meshes/`: the surface of each, and its convex parts. */
export function meshFiles(bodies: readonly ExportedBody[]): Record<string, string> {
  const files: Record<string, string> = {};
  for (const { name, mesh, parts } of bodies) {
    files[`meshes/${name}.obj`] = objOf(mesh);
    for (const part of parts) files[`meshes/${part.name}.obj`] = objOf(part);
  }
  return files;
}

/** A mesh as Wavefront OBJ. */
function objOf({ positions, indices }: { positions: ArrayLike<number>; indices: ArrayLike<number> }): string {
  const lines = [`# ${GENERATOR}`];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    lines.push(`v ${spaced([positions[i] as number, positions[i + 1] as number, positions[i + 2] as number])}`);
  }
  for (let i = 0; i + 2 < indices.length; i += 3) {
    lines.push(`f ${[0, 1, 2].map((k) => (indices[i + k] as number) + 1).join(" ")}`);
  }
  return `${lines.join("\n")}\n`;
}

/** The inertia about the centre of mass, in the axes of the body: rows. */
export function inertiaOf({ principalMoments, principalAxes }: ExportedBody): Matrix3 {
  const axes = rotationOfUnit(principalAxes);
  const scaled = axes.map((x, i) => x * (principalMoments[i % 3] as number)) as unknown as Matrix3;
  return product(scaled, transposed(axes));
}

/** World from the view of MuJoCo's and USD's cameras, which look along −z, with y up: half a turn about x. */
export const viewRotation = ({ rotation: [x, y, z, w] }: ExportedScene["camera"] & object): Quaternion => [
  w,
  z,
  -y,
  -x,
];

/** How far the principal point of a camera is from the middle of its image, pixels: to the right, and down. */
export const principalOffset = ({ cx, cy, width, height }: ExportedScene["camera"] & object): [number, number] => [
  cx + 0.5 - width / 2,
  cy + 0.5 - height / 2,
];

/** The pairs of bodies of which one is partly inside the other, by name. */
export const overlappingPairs = (bodies: readonly ExportedBody[]): [one: string, other: string][] =>
  bodies.flatMap(({ name, inside }, i) =>
    inside.flatMap((k): [string, string][] => (k > i ? [[name, (bodies[k] as ExportedBody).name]] : [])),
  );
