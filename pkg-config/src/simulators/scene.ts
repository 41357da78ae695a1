/** Scenes for simulators: rigid bodies at rest, the ground and the camera, in a frame with z up. */
import { meshOf } from "../conventions/mesh.js";
import { Names } from "../conventions/names.js";
import { quaternionOf } from "../conventions/rotation.js";
import { type SceneCamera, sceneCamera, sceneFromCamera, sceneObjects } from "../conventions/scene-frame.js";
import { composed, type Similarity, sim3Of, similarityOf } from "../conventions/similarity.js";
import { WasmModule } from "../modules/module.js";
import type { Sim3Like } from "../types/argument-types.js";
import type { MeshArrays } from "../types/inputs.js";
import type { WasmSource } from "../types/platform.js";
import type { Plane } from "../types/scene.js";
import { invalidArgument } from "../values/error.js";
import { isRecord, isTypedArray } from "../values/kinds.js";
import { optionsOf, positive, type Quaternion, type Vector3, whole } from "../values/validation.js";

/** An object of a scene for a simulator. */
export interface SimulatorObject {
  /** The name of the object, from which the name of its body is made. */
  name?: string | undefined;
  /** The aligned mesh; `readMesh` of `sim3align/formats` reads files, with their colours. */
  mesh: MeshArrays;
  /** OpenCV camera from mesh, metres: an object of the result of `alignScene`. */
  transform: Sim3Like;
  /**
   * What it rests on: the support, another object by its index in this list, or nothing that is exported. Default: that of
   * `contact` in the transform, and the support for a transform without one.
   */
  restsOn?: "support" | "level" | number | null | undefined;
}

/** Options of {@link simulatorScene}. */
export interface SimulatorOptions {
  /**
   * The plane that the objects stand on, as `support` of the result: the ground, z = 0. Without one, all bodies are fixed. A
   * plane with a `confidence` below 1 was found, and is moved along its normal to where most of the objects stand: objects are
   * found more exactly than planes. Others are kept.
   */
  support?: (Plane & { confidence?: number | undefined }) | null | undefined;
  /** The camera. */
  camera?: SceneCamera | undefined;
  /** Mass per volume that a mesh encloses, or of the convex parts of an open one, kg/m³. Default {@link SIMULATOR_DEFAULTS}: household things are mostly hollow. */
  density?: number | undefined;
  /** Most convex parts of a body; 1 is the convex hull. See `wallsJoined` of the bodies. */
  maxParts?: number | undefined;
  /** Largest angle by which a body is turned so that it rests, degrees. */
  maxTurnDeg?: number | undefined;
  /** Largest distance of any point of the surface of a body from where it was found, metres. */
  maxMoveM?: number | undefined;
  /** Whether bodies are put at rest; without it, each keeps the pose of its transform. */
  rest?: boolean | undefined;
  /** The physics module, if it is not at `wasm/physics_bg.wasm` beside this script. Only the first one is used. */
  wasm?: WasmSource | undefined;
}

/** Defaults of {@link SimulatorOptions}. */
export const SIMULATOR_DEFAULTS = { density: 400, maxParts: 16, maxTurnDeg: 1, maxMoveM: 0.0025, rest: true } as const;

/** The names of the options. */
const OPTIONS = ["support", "camera", "density", "maxParts", "maxTurnDeg", "maxMoveM", "rest", "wasm"] as const;

/** A convex surface. */
export interface ConvexPart {
  /** Interleaved x, y, z, metres, in the frame of the body. */
  positions: Float64Array;
  /** Three vertex indices per triangle, counter-clockwise from outside. */
  indices: Uint32Array;
}

/** A pose of a body. */
export interface SimulatorPose {
  /** World from body, metres. */
  position: Vector3;
  /** World from body, x, y, z, w. */
  rotation: Quaternion;
}

/** A rigid body. Its frame is that of its mesh, in metres. */
export interface SimulatorBody extends SimulatorPose {
  /** A name of letters, digits and underscores, unique in the scene. */
  name: string;
  /** The pose of its transform: before it was put at rest. */
  found: SimulatorPose;
  /** Whether it is fixed to the world: it rests on nothing in the scene, or would not rest at its place. */
  isFixed: boolean;
  /** Kilograms. */
  mass: number;
  /** In the frame of the body, metres. */
  centerOfMass: Vector3;
  /** Moments of inertia about the principal axes, kg·m². */
  principalMoments: Vector3;
  /** Body from principal axes, x, y, z, w. */
  principalAxes: Quaternion;
  /** Convex parts for collisions. */
  parts: ConvexPart[];
  /** The surface, metres. */
  mesh: { positions: Float32Array; indices: Uint32Array };
  /** The mean colour, red, green and blue, 0 to 1, sRGB-encoded. */
  color: Vector3;
  /** How far the farthest point of its surface is from its place in the pose of the transform, metres. */
  movedM: number;
  /** How far it was turned, degrees. */
  turnedDeg: number;
  /**
   * How far its farthest point would move, and how far it would turn, so that the whole body rests: beyond `maxMoveM` or
   * `maxTurnDeg`, it keeps its rotation. `null` if it rests on nothing in the scene, or would tip over there.
   */
  rest: { moveM: number; turnDeg: number } | null;
  /**
   * By how much its parts are cut level from below, metres, so that it rests at the rotation at which it was found. Its surface
   * is whole, and sinks into what it stands on by at most as much.
   */
  cutM: number;
  /**
   * The number of walls of an open box or shelf without thickness, if `maxParts` is smaller: its parts then join walls and close
   * its openings. Otherwise `null`.
   */
  wallsJoined: number | null;
  /** Indices of the bodies that it is partly inside of: collisions with these are left out where a format can say so. */
  inside: number[];
}

/** A scene for simulators: metres, kilograms, z up, the ground at z = 0. */
export interface SimulatorScene {
  bodies: SimulatorBody[];
  hasGround: boolean;
  /** The height of the given support above the ground, metres: 0 unless it was moved to the objects. */
  supportHeightM: number;
  /** World from camera (x right, y down, z forward), its vertical field of view, and its intrinsics in pixels. */
  camera: (SimulatorPose & Required<Record<keyof SceneCamera | "fovYDeg", number>>) | null;
}

/** A pose as the physics module returns it. */
interface BodyPose {
  rotation: Float64Array;
  translation: Float64Array;
}

/** The functions of the physics module. */
interface Physics {
  settleBodies(
    objects: readonly object[],
    settings: object,
  ): {
    bodies: (Pick<
      SimulatorBody,
      "parts" | "mass" | "movedM" | "turnedDeg" | "rest" | "cutM" | "inside" | "wallsJoined"
    > &
      Record<"pose" | "found", BodyPose> &
      Record<"center" | "moments" | "axes", Float64Array> & { isFree: boolean })[];
    supportHeightM: number;
  };
}

/** The physics module, shared by all scenes of this realm. */
const physicsModule = /* @__PURE__ */ new WasmModule<Physics>(
  "physics",
  () => new URL("../wasm/physics_bg.wasm", import.meta.url),
  () => import("../wasm/physics.js"),
);

/**
 * Makes a scene for simulators. Each object becomes a rigid body with convex parts for collisions (V-HACD), and mass and
 * inertia of a density. An object that rests on the support or on another object is moved and turned a little, so that it
 * rests there by itself, or keeps its rotation while the underside of its parts is cut level; one for which neither is enough, one
 * that hangs, and one that stands on what is no object are fixed where they were found. `found` keeps the pose before.
 *
 * @example
 * const { objects, support } = await aligner.alignScene(scene);
 * const simulated = await simulatorScene([{ name: "mug", mesh, transform: objects[0] }], { support });
 * const files = toMjcf(simulated);
 * @throws {@link Sim3AlignError} for an invalid mesh, transform or option, and `NOT_INITIALISED`
 */
export async function simulatorScene(
  objects: readonly SimulatorObject[],
  options: SimulatorOptions = {},
): Promise<SimulatorScene> {
  const { support = null, camera, wasm, ...given } = optionsOf(options, OPTIONS);
  const settings = settingsOf(given);
  const own = sceneObjects(objects, (i) => `object_${i}`);
  const poses = own.map(({ transform }) => similarityOf(transform));
  const centers = poses.map(({ translation }) => translation);
  const worldFromCamera = sceneFromCamera(support, centers, "z");
  const meshes = own.map(({ mesh }) => surfaceOf(mesh));
  const module = await physicsModule.load(wasm);
  const sent = poses.map((pose, i) => ({
    mesh: meshes[i],
    transform: sim3Of(composed(worldFromCamera, pose)).matrix,
    on: support === null ? null : groundOf(own[i] as SimulatorObject, own.length),
  }));
  const fitsGround = support?.confidence !== undefined && support.confidence < 1;
  const { bodies, supportHeightM } = module.call((physics) => physics.settleBodies(sent, { ...settings, fitsGround }));
  const names = new Names();
  return {
    bodies: bodies.map(({ pose, found, center, moments, axes, isFree, ...body }, i): SimulatorBody => {
      const { positions, indices } = meshes[i] as (typeof meshes)[number];
      const { scale } = poses[i] as Similarity;
      const name = names.own((own[i] as (typeof own)[number]).name);
      return {
        ...{ name, ...poseOf(pose), found: poseOf(found), isFixed: !isFree, ...body },
        centerOfMass: Array.from(center) as Vector3,
        principalMoments: Array.from(moments) as Vector3,
        principalAxes: Array.from(axes) as Quaternion,
        mesh: { positions: positions.map((x) => x * scale), indices },
        color: meanColour((own[i] as SimulatorObject).mesh),
      };
    }),
    hasGround: support !== null,
    supportHeightM,
    camera: camera === undefined ? null : cameraOf(camera, worldFromCamera, supportHeightM),
  };
}

const poseOf = ({ translation, rotation }: BodyPose): SimulatorPose => ({
  position: Array.from(translation) as Vector3,
  rotation: Array.from(rotation) as Quaternion,
});

function settingsOf(given: Omit<SimulatorOptions, "support" | "camera">): object {
  const { density, maxParts, maxTurnDeg, maxMoveM, rest } = { ...SIMULATOR_DEFAULTS, ...given };
  if (typeof rest !== "boolean") throw invalidArgument("options.rest", rest, "true or false", "Pass one of them.");
  return {
    density: positive("options.density", density),
    parts: Math.min(whole("options.maxParts", maxParts, 1), 64),
    turnDeg: positive("options.maxTurnDeg", maxTurnDeg),
    moveM: positive("options.maxMoveM", maxMoveM),
    rest,
  };
}

function cameraOf(given: unknown, { translation, rotation }: Similarity, liftM: number): SimulatorScene["camera"] {
  const { fovYRad, ...intrinsics } = sceneCamera(given);
  const [x, y, z] = translation;
  const fovYDeg = (fovYRad * 180) / Math.PI;
  return { position: [x, y, z + liftM], rotation: quaternionOf(rotation), fovYDeg, ...intrinsics };
}

/** The support of an object, for the module. */
function groundOf({ restsOn, transform }: SimulatorObject, count: number): "support" | number | null {
  const contact = isRecord(transform) ? (transform as Record<string, unknown>).contact : undefined;
  const on = restsOn === undefined ? (isRecord(contact) ? contact.restsOn : "support") : restsOn;
  if (on === "support") return on;
  return typeof on === "number" && Number.isInteger(on) && on >= 0 && on < count ? on : null;
}

interface Surface {
  positions: Float32Array;
  indices: Uint32Array;
}

/**
 * A surface without faces of fewer than three places, and without repeated ones, of which importers warn, and which leave a
 * mesh open that else encloses a volume. Two solids that share a face keep it twice: there it closes both.
 */
function surfaceOf(mesh: unknown): Surface {
  const { positions, indices } = meshOf("mesh", mesh);
  const all = indices ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  const places = Array.from({ length: positions.length / 3 }, (_, i) => positions.subarray(3 * i, 3 * i + 3).join());
  const faces: { corners: number[]; key: string; edges: [there: string, back: string][] }[] = [];
  const repeats = new Map<string, number>();
  // How many more faces run along an edge than back: 0 where a surface is closed.
  const excess = new Map<string, number>();
  const add = (counts: Map<string, number>, key: string, by: number) => counts.set(key, (counts.get(key) ?? 0) + by);
  const count = ({ key, edges }: (typeof faces)[number], by: number) => {
    add(repeats, key, by);
    for (const [there, back] of edges) {
      add(excess, there, by);
      add(excess, back, -by);
    }
  };
  for (let i = 0; i + 2 < all.length; i += 3) {
    const corners = [...all.subarray(i, i + 3)];
    const own = corners.map((corner) => places[corner] as string);
    if (new Set(own).size < 3) continue;
    const edges = own.map((from, k): [string, string] => {
      const to = own[(k + 1) % 3] as string;
      return [`${from} ${to}`, `${to} ${from}`];
    });
    const face = { corners, key: own.sort().join(" "), edges };
    faces.push(face);
    count(face, 1);
  }

  const isDoubled = [...repeats.values()].every((times) => times > 1);
  const kept = faces.filter((face) => {
    const isExtra = isDoubled || face.edges.some(([there]) => (excess.get(there) ?? 0) > 0);
    if ((repeats.get(face.key) ?? 0) < 2 || !isExtra) return true;
    count(face, -1);
    return false;
  });
  return { positions, indices: Uint32Array.from(kept.length === 0 ? all : kept.flatMap(({ corners }) => corners)) };
}

const GREY: Vector3 = [0.7, 0.7, 0.7];

function meanColour(mesh: SimulatorObject["mesh"]): Vector3 {
  const colors = mesh.samples?.colors ?? (mesh as { colors?: unknown }).colors;
  if (!isTypedArray<Uint8Array>(colors, "Uint8Array") || colors.length === 0 || colors.length % 3 !== 0) return GREY;
  const sum: Vector3 = [0, 0, 0];
  colors.forEach((part, i) => {
    sum[(i % 3) as 0] += part;
  });
  return sum.map((part) => (3 * part) / colors.length / 255) as Vector3;
}
