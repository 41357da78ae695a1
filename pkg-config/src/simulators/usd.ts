/** Scenes as USD, with the schemas of UsdPhysics. */
import { bounds } from "../conventions/mesh.js";
import { wFirst } from "../conventions/rotation.js";
import { lightOf } from "../input/colors.js";
import type { Quaternion } from "../values/validation.js";
import { type ExportedBody, exportedScene, GENERATOR, principalOffset, spaced, viewRotation } from "./exported.js";
import type { SimulatorScene } from "./scene.js";

const tuple = (numbers: ArrayLike<number>) => `(${spaced(numbers).replaceAll(" ", ", ")})`;
/** Quaternions of USD begin with w. */
const quaternion = (xyzw: Quaternion) => tuple(wFirst(xyzw));

/** Reach of the ground, metres, and its colour. */
const REACH = 5;
const GREY = [0.75, 0.77, 0.79];

/** The schemas of surfaces that collide. */
const COLLIDER = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"];

/**
 * A scene as the text of a USD file (`.usda`): metres, z up, rigid bodies with mass and convex colliders, the ground, and
 * the camera. Bodies that are fixed are colliders only. `found:translate` and `found:orient` are the pose of a body before it
 * was put at rest.
 */
export function toUsd(scene: SimulatorScene): string {
  const { bodies, hasGround, camera } = exportedScene(scene);
  const prims: string[] = [
    `def PhysicsScene "physics"
{
    vector3f physics:gravityDirection = (0, 0, -1)
    float physics:gravityMagnitude = 9.81
}`,
    `def DistantLight "light"
{
    float inputs:intensity = 1500
    double3 xformOp:rotateXYZ = (25, 20, 0)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
}`,
  ];
  if (hasGround) {
    // A plane without end; solvers refuse meshes that are one.
    prims.push(`def Plane "ground" (
    prepend apiSchemas = ["PhysicsCollisionAPI"]
)
{
    uniform token axis = "Z"
    double width = ${2 * REACH}
    double length = ${2 * REACH}
    uniform bool doubleSided = 1
    color3f[] primvars:displayColor = [${tuple(GREY.map(lightOf))}]
}`);
  }
  if (camera !== null) {
    // Apertures are in tenths of a unit.
    const vertical = 24;
    const { width, height, fx, fy } = camera;
    const focal = (vertical * fy) / height;
    const horizontal = (focal * width) / fx;
    const [right, down] = principalOffset(camera);
    prims.push(`def Camera "camera"
{
    float focalLength = ${spaced([focal])}
    float horizontalAperture = ${spaced([horizontal])}
    float horizontalApertureOffset = ${spaced([(-right * horizontal) / width])}
    float verticalAperture = ${vertical}
    float verticalApertureOffset = ${spaced([(down * vertical) / height])}
    float2 clippingRange = (0.01, 100)
${placement(camera.position, viewRotation(camera))}
}`);
  }
  const names = bodies.map(({ name }) => name);
  prims.push(...bodies.map((body) => bodyPrim(body, names)));
  return `#usda 1.0
(
    doc = "${GENERATOR}"
    defaultPrim = "World"
    kilogramsPerUnit = 1
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "World"
{
${indented(prims.join("\n\n"))}
}
`;
}

function bodyPrim(body: ExportedBody, names: readonly string[]): string {
  const { name, isFixed, inside, position, rotation, found, parts, color } = body;
  const filtered = inside.map((k) => `</World/${names[k]}>`);
  const schemas = [
    ...(isFixed ? [] : ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]),
    ...(filtered.length > 0 ? ["PhysicsFilteredPairsAPI"] : []),
  ];
  const mass = [
    `float physics:mass = ${spaced([body.mass])}`,
    `point3f physics:centerOfMass = ${tuple(body.centerOfMass)}`,
    `float3 physics:diagonalInertia = ${tuple(body.principalMoments)}`,
    `quatf physics:principalAxes = ${quaternion(body.principalAxes)}`,
  ];
  const properties = [
    `custom double3 found:translate = ${tuple(found.position)}`,
    `custom quatd found:orient = ${quaternion(found.rotation)}`,
    ...(isFixed ? [] : mass),
    ...(filtered.length > 0 ? [`rel physics:filteredPairs = [${filtered.join(", ")}]`] : []),
  ].map((line) => `    ${line}\n`);
  const hull = [`uniform token physics:approximation = "convexHull"`, `uniform token purpose = "guide"`];
  // Importers that merge a prim with its only child take the name of the child.
  const colliders = parts.map((part, k) => mesh(`${name}_collider_${k}`, part, color, COLLIDER, hull));
  return `def Xform "${name}"${applied(schemas)}
{
${properties.join("")}${placement(position, rotation)}

${indented([mesh(name, body.mesh, color, [], []), ...colliders].join("\n\n"))}
}`;
}

/** The schemas of a prim, which stand after its name. */
const applied = (schemas: readonly string[]) =>
  schemas.length === 0 ? "" : ` (\n    prepend apiSchemas = [${schemas.map((s) => `"${s}"`).join(", ")}]\n)`;

const placement = (position: ArrayLike<number>, rotation: Quaternion) =>
  `    double3 xformOp:translate = ${tuple(position)}
    quatd xformOp:orient = ${quaternion(rotation)}
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]`;

function mesh(
  name: string,
  { positions, indices }: { positions: ArrayLike<number>; indices: ArrayLike<number> },
  color: readonly number[],
  schemas: readonly string[],
  properties: readonly string[],
): string {
  const points = Array.from({ length: positions.length / 3 }, (_, i) =>
    [0, 1, 2].map((k) => positions[3 * i + k] as number),
  );
  const { min, max } = bounds(positions);
  // Colours of USD are proportional to light.
  const light = color.map(lightOf);
  return `def Mesh "${name}"${applied(schemas)}
{
${properties.map((line) => `    ${line}\n`).join("")}    uniform bool doubleSided = 1
    float3[] extent = [${tuple(min)}, ${tuple(max)}]
    int[] faceVertexCounts = [${Array.from({ length: indices.length / 3 }, () => 3).join(", ")}]
    int[] faceVertexIndices = [${Array.from(indices).join(", ")}]
    point3f[] points = [${points.map(tuple).join(", ")}]
    color3f[] primvars:displayColor = [${tuple(light)}]
    uniform token subdivisionScheme = "none"
}`;
}

const indented = (text: string) => text.replace(/^(?=.)/gm, "    ");
