/** Conventions of camera poses: those in which contradicting views would agree. */
import { openGlAxes } from "../conventions/frames.js";
import { composed, inverted, moved, type Similarity, sim3Of, similarityOf } from "../conventions/similarity.js";
import type { CoreFrame } from "../modules/core-input.js";
import type { Vector3 } from "../values/validation.js";
import { objectSeen } from "./readings.js";

/** A convention of camera poses. */
interface Convention {
  /** How a pose in it becomes one of this package, for people. */
  remedy: string;
  /** The pose of the camera (OpenCV) in the world, in metres. */
  read(pose: Similarity): Similarity;
}

const axes: Convention[] = [
  {
    remedy:
      "have the axes of OpenGL (y up, looking along −z), as those of ARKit, Blender and nerfstudio: multiply them by diag(1, −1, −1, 1) from the right",
    read: (pose) => composed(pose, openGlAxes),
  },
  { remedy: "are world-to-camera (extrinsics): invert them", read: inverted },
  {
    remedy:
      "are world-to-camera with the axes of OpenGL: multiply them by diag(1, −1, −1, 1) from the left, and invert them",
    read: (pose) => inverted(composed(openGlAxes, pose)),
  },
];

const units = [
  { name: "millimetres", metres: 0.001 },
  { name: "centimetres", metres: 0.01 },
];

const conventions: readonly Convention[] = [
  ...axes,
  ...units.flatMap(({ name, metres }) => {
    const inMetres = ({ translation, ...pose }: Similarity): Similarity => ({
      ...pose,
      translation: translation.map((x) => metres * x) as Vector3,
    });
    const unit = `are in ${name}: multiply their translations by ${metres}`;
    return [
      { remedy: unit, read: inMetres },
      ...axes.map(({ remedy, read }) => ({
        remedy: `${unit}; and they ${remedy}`,
        read: (pose: Similarity) => read(inMetres(pose)),
      })),
    ];
  }),
];

/**
 * The largest distance of what the views see in the world, in extents of the object: opposite sides of it are one apart, and the
 * masks of some views may be wrong.
 */
const APART = 1.5;
/** Number of conventions in which the views are aligned. */
const TRIED = 2;

/**
 * The remedy for camera poses of another convention, in which the views agree; `undefined` if there is none.
 * @param agree whether views with such poses agree
 */
export async function otherConvention(
  views: readonly CoreFrame[],
  agree: (views: readonly CoreFrame[]) => Promise<boolean>,
): Promise<string | undefined> {
  const poses = views.map(({ cameraToWorld }) => cameraToWorld && similarityOf(cameraToWorld, "cameraToWorld"));
  const seen = views.map(objectSeen);
  const extent = median(seen.flatMap((object) => object?.extent ?? []));

  const apart = conventions.map((convention) => {
    const middles = seen.flatMap((object, k) => {
      const pose = poses[k];
      return object && pose ? [moved(convention.read(pose as Similarity), object.middle)] : [];
    });
    const middle = [0, 1, 2].map((axis) => median(middles.map((point) => point[axis] as number)));
    const distances = middles.map((point) => Math.hypot(...point.map((x, axis) => x - (middle[axis] as number))));
    return { convention, distance: median(distances) };
  });
  const likely = apart.filter(({ distance }) => distance < APART * extent).sort((a, b) => a.distance - b.distance);
  for (const { convention } of likely.slice(0, TRIED)) {
    const read = views.map((view, k) => {
      const pose = poses[k];
      return pose ? { ...view, cameraToWorld: sim3Of(convention.read(pose as Similarity)) } : view;
    });
    if (await agree(read)) return convention.remedy;
  }
  return undefined;
}

const median = (values: readonly number[]): number =>
  [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? 0;
