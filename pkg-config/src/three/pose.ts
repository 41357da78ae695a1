/** Poses of three.js objects. */
import { fromFrame, toFrame } from "../conventions/frames.js";
import { compose, invert, toSim3 } from "../conventions/similarity.js";
import type { Sim3, Sim3Like } from "../input/sim3.js";
import { withForeignObject } from "../values/foreign-objects.js";
import { finiteNumbers, knownOptions, oneOf } from "../values/validation.js";
import type { PlacedObject, PosableObject } from "./types.js";

/** Options of {@link applyToObject3D} and {@link transformFromObject3D}. */
export interface PoseOptions {
  /**
   * The frame of the object's parent (without `camera`): "opengl", the default, for a child of a three.js camera, or of
   * a scene whose camera is at the origin without rotation; "opencv" for a scene in the OpenCV camera frame.
   */
  frame?: "opencv" | "opengl" | undefined;
  /** The three.js camera that represents the depth camera, anywhere in the scene. */
  camera?: PlacedObject | undefined;
}

const OBJECT = "an Object3D";
const framesOfScenes = ["opencv", "opengl"] as const;

/**
 * Places a three.js object by an alignment: sets its `position`, `quaternion` and `scale`.
 *
 * The aligned mesh must be that of {@link meshInputFromThree} for this object. The parent of the object is the three.js
 * camera, or a scene whose camera is at the origin. If the camera is elsewhere, pass it as `camera`; the parent may
 * then be any object without shear and non-uniform scale.
 *
 * @param object an `Object3D`
 * @param transform OpenCV camera from mesh: a result of `align`
 *
 * @example
 * const { scene: object } = await new GLTFLoader().loadAsync("generated.glb");
 * const result = await aligner.align({ depth, mask, camera, mesh: meshInputFromThree(object) });
 * applyToObject3D(object, result);
 * @throws {@link Sim3AlignError} if the transform is not a similarity, and `INVALID_OPTION` for another frame
 */
export function applyToObject3D(
  object: PosableObject & { readonly parent?: PlacedObject | null },
  transform: Sim3Like,
  options: PoseOptions = {},
): void {
  withForeignObject("object", OBJECT, () => place(object, transform, options));
}

function place(
  object: PosableObject & { readonly parent?: PlacedObject | null },
  transform: Sim3Like,
  options: PoseOptions,
): void {
  const { frame = "opengl", camera } = knownOptions(options, ["frame", "camera"]);
  oneOf("options.frame", frame, framesOfScenes);
  let pose = toFrame(transform, camera === undefined ? frame : "opengl");
  if (camera !== undefined) {
    pose = compose(worldFromCamera(camera), pose);
    if (object.parent) pose = compose(invert(worldFrom("object.parent", object.parent)), pose);
  }
  object.position.set(...pose.translation);
  object.quaternion.set(...pose.rotation);
  object.scale.set(pose.scale, pose.scale, pose.scale);
  // For objects without `matrixAutoUpdate`.
  object.updateMatrix();
}

/**
 * The transform of a three.js object, for `evaluate` or the option `initial`. The inverse of {@link applyToObject3D}:
 * use it after a user has moved the object.
 *
 * @param object an `Object3D` with a uniform scale
 * @param options those passed to {@link applyToObject3D}
 * @returns OpenCV camera from mesh, metres
 *
 * @example
 * const initial = transformFromObject3D(object);
 * await aligner.align(input, { initial, search: "local" });
 * @throws {@link Sim3AlignError} `INVALID_TRANSFORM` for an object with a non-uniform scale or a reflection
 */
export function transformFromObject3D(object: PosableObject, options: PoseOptions = {}): Sim3 {
  return withForeignObject("object", OBJECT, () => {
    const { frame = "opengl", camera } = knownOptions(options, ["frame", "camera"]);
    oneOf("options.frame", frame, framesOfScenes);
    if (camera !== undefined)
      return fromFrame(compose(invert(worldFromCamera(camera)), worldFrom("object", object)), "opengl");
    object.updateMatrix();
    return fromFrame(numbersOf("object.matrix", object.matrix), frame);
  });
}

/** The transform of an object in its scene. */
const worldFrom = (argument: string, object: PlacedObject): Sim3 =>
  withForeignObject(argument, OBJECT, () => {
    object.updateWorldMatrix(true, false);
    return toSim3(numbersOf(`${argument}.matrixWorld`, object.matrixWorld));
  });

/**
 * The inverse of what three.js renders with: whether it contains the scale of a camera's parents depends on its version. Other
 * objects stand for a camera without scale.
 */
function worldFromCamera(
  camera: PlacedObject & { readonly matrixWorldInverse?: PlacedObject["matrixWorld"] },
): Sim3Like {
  const world = worldFrom("options.camera", camera);
  const inverse = camera.matrixWorldInverse;
  return inverse === undefined
    ? { ...world, scale: 1 }
    : invert(numbersOf("options.camera.matrixWorldInverse", inverse));
}

const numbersOf = (argument: string, { elements }: { readonly elements: unknown }) =>
  finiteNumbers(`${argument}.elements`, elements, 16, "16 finite numbers");
