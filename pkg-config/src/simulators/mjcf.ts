/** Scenes as MJCF, the format of MuJoCo. */
import { wFirst } from "../conventions/rotation.js";
import {
  type ExportedBody,
  type ExportedScene,
  exportedScene,
  GENERATOR,
  meshFiles,
  overlappingPairs,
  principalOffset,
  spaced,
  viewRotation,
} from "./exported.js";
import type { SimulatorScene } from "./scene.js";

/**
 * A scene as MJCF, texts by path: `scene.xml`, and a mesh in `meshes/` for each body and each of its convex parts. A `numeric` named
 * `NAME_found` holds the pose of a body before it was put at rest, as `pos` and `quat`.
 *
 * @example
 * for (const [path, text] of Object.entries(toMjcf(scene))) await writeFile(path, text);
 */
export function toMjcf(scene: SimulatorScene): Record<string, string> {
  const { bodies, hasGround, camera } = exportedScene(scene);
  const assets = bodies.flatMap(({ name, parts }) => [
    // Its inertia is not used: surfaces of generated meshes need not be closed.
    `<mesh name="${name}" file="${name}.obj" inertia="shell"/>`,
    ...parts.map((part) => `<mesh name="${part.name}" file="${part.name}.obj"/>`),
  ]);
  const world: string[] = [`<light directional="true" pos="0 0 3" dir="0.3 0.4 -1"/>`];
  if (hasGround) {
    assets.push(
      `<texture name="ground" type="2d" builtin="checker" rgb1=".8 .82 .84" rgb2=".74 .76 .78" width="256" height="256"/>`,
      `<material name="ground" texture="ground" texrepeat="10 10" texuniform="true"/>`,
    );
    world.push(`<geom name="ground" type="plane" size="2 2 0.05" material="ground"/>`);
  }
  if (camera !== null) {
    world.push(cameraLine(camera));
  }
  world.push(...bodies.flatMap(bodyLines));
  const excluded = overlappingPairs(bodies).map(([one, other]) => `<exclude body1="${one}" body2="${other}"/>`);
  const found = bodies.map(({ name, found: { position, rotation } }) => {
    const pose = spaced([...position, ...wFirst(rotation)]);
    return `<numeric name="${name}_found" size="7" data="${pose}"/>`;
  });
  const text = `<!-- ${GENERATOR} -->
<mujoco model="scene">
  <compiler angle="radian" meshdir="meshes"/>
  <option integrator="implicitfast" cone="elliptic" impratio="10">
    <flag multiccd="enable"/>
  </option>
  <default>
    <default class="visual">
      <geom type="mesh" contype="0" conaffinity="0" group="2" mass="0"/>
    </default>
    <default class="collision">
      <geom type="mesh" group="3" condim="6" friction="0.8 0.005 0.001"/>
    </default>
  </default>
${section("custom", found)}
${section("asset", assets)}
${section("worldbody", world)}
${excluded.length > 0 ? `${section("contact", excluded)}\n` : ""}</mujoco>
`;
  return { ...meshFiles(bodies), "scene.xml": text };
}

/** The camera. MuJoCo derives the field of view from the focal lengths if it has the size of a sensor, here a metre high. */
function cameraLine(camera: ExportedScene["camera"] & object): string {
  const { position, width, height, fx, fy } = camera;
  const pose = `pos="${spaced(position)}" quat="${spaced(wFirst(viewRotation(camera)))}"`;
  const sensor = `resolution="${Math.round(width)} ${Math.round(height)}" sensorsize="${spaced([width / height, 1])}"`;
  // Its offsets are to the left, and up.
  const offset = principalOffset(camera).map((pixels) => 0 - pixels);
  return `<camera name="camera" ${pose} ${sensor} focalpixel="${spaced([fx, fy])}" principalpixel="${spaced(offset)}"/>`;
}

function bodyLines(body: ExportedBody): string[] {
  const { name, position, rotation, isFixed, parts, color } = body;
  const pose = `pos="${spaced(position)}" quat="${spaced(wFirst(rotation))}"`;
  const inertial = `<inertial pos="${spaced(body.centerOfMass)}" quat="${spaced(wFirst(body.principalAxes))}" mass="${spaced([body.mass])}" diaginertia="${spaced(body.principalMoments)}"/>`;
  return [
    `<body name="${name}" ${pose}>`,
    ...(isFixed ? [] : ["  <freejoint/>"]),
    ...(parts.length > 0 ? [`  ${inertial}`] : []),
    `  <geom class="visual" mesh="${name}" rgba="${spaced([...color, 1])}"/>`,
    ...parts.map((part) => `  <geom class="collision" mesh="${part.name}"/>`),
    "</body>",
  ];
}

const section = (tag: string, lines: readonly string[]) =>
  `  <${tag}>\n${lines.map((line) => `    ${line}\n`).join("")}  </${tag}>`;
