/** Scenes as URDF: a file per body, and a list of their poses. */
import { entry } from "../conventions/rotation.js";
import {
  type ExportedBody,
  type ExportedScene,
  exportedScene,
  GENERATOR,
  inertiaOf,
  meshFiles,
  overlappingPairs,
  spaced,
} from "./exported.js";
import type { SimulatorScene } from "./scene.js";

/** A program that loads the files into PyBullet. */
const loader = `# ${GENERATOR}
"""Loads the scene into PyBullet: \`python load.py\` shows it; load(client) returns the bodies by name."""
import json
import os

import pybullet


def load(client, folder=os.path.dirname(os.path.abspath(__file__))):
    with open(os.path.join(folder, "scene.json")) as file:
        scene = json.load(file)
    pybullet.setGravity(*scene["gravity"], physicsClientId=client)
    ids = {}
    for body in scene["bodies"]:
        ids[body["name"]] = pybullet.loadURDF(
            os.path.join(folder, body["file"]),
            body["position"],
            body["quaternion"],
            useFixedBase=body["fixed"],
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
            physicsClientId=client,
        )
    for one, other in scene["withoutCollision"]:
        pybullet.setCollisionFilterPair(ids[one], ids[other], -1, -1, 0, physicsClientId=client)
    return ids


def pose(client, body):
    """Position and quaternion of a body as in scene.json: PyBullet's own are of the frame of inertia."""
    position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    inertial = pybullet.getDynamicsInfo(body, -1, physicsClientId=client)[3:5]
    return pybullet.multiplyTransforms(position, quaternion, *pybullet.invertTransform(*inertial))


if __name__ == "__main__":
    client = pybullet.connect(pybullet.GUI)
    load(client)
    pybullet.setRealTimeSimulation(1)
    input("Enter ends the program.")
`;

/**
 * A scene as URDF, texts by path: `NAME.urdf` for each body, `ground.urdf`, their meshes, `scene.json` with poses (metres, quaternions
 * x, y, z, w, z up; `found` is the pose before a body was put at rest), and `load.py` for PyBullet.
 */
export function toUrdf(scene: SimulatorScene): Record<string, string> {
  const { bodies, hasGround, camera } = exportedScene(scene);
  const files: Record<string, string> = { "load.py": loader, ...meshFiles(bodies) };
  for (const body of bodies) files[`${body.name}.urdf`] = urdfOf(body);
  if (hasGround) files["ground.urdf"] = ground;
  const entries = bodies.map(({ name, position, rotation, isFixed, found }) => ({
    ...{ name, file: `${name}.urdf`, position, quaternion: rotation, fixed: isFixed },
    found: { position: found.position, quaternion: found.rotation },
  }));
  const floor = { name: "ground", file: "ground.urdf", position: [0, 0, 0], quaternion: [0, 0, 0, 1], fixed: true };
  const list = {
    generator: GENERATOR,
    gravity: [0, 0, -9.81],
    bodies: hasGround ? [floor, ...entries] : entries,
    withoutCollision: overlappingPairs(bodies),
    camera: camera === null ? null : viewOf(camera),
  };
  files["scene.json"] = `${JSON.stringify(list, null, 2)}\n`;
  return files;
}

function viewOf({ position, rotation, ...intrinsics }: ExportedScene["camera"] & object) {
  return { position, quaternion: rotation, ...intrinsics };
}

const contact = `<contact><lateral_friction value="0.8"/><rolling_friction value="0.001"/><spinning_friction value="0.002"/></contact>`;

function urdfOf(body: ExportedBody): string {
  const { name, mass, centerOfMass, parts, color } = body;
  const inertia = inertiaOf(body);
  const at = (i: 0 | 1 | 2, j: 0 | 1 | 2) => spaced([entry(inertia, i, j)]);
  const mesh = (file: string) =>
    `<origin xyz="0 0 0" rpy="0 0 0"/><geometry><mesh filename="meshes/${file}.obj"/></geometry>`;
  const lines = [
    contact,
    `<inertial><origin xyz="${spaced(centerOfMass)}" rpy="0 0 0"/><mass value="${spaced([mass])}"/><inertia ixx="${at(0, 0)}" ixy="${at(0, 1)}" ixz="${at(0, 2)}" iyy="${at(1, 1)}" iyz="${at(1, 2)}" izz="${at(2, 2)}"/></inertial>`,
    `<visual>${mesh(name)}<material name="colour"><color rgba="${spaced([...color, 1])}"/></material></visual>`,
    ...parts.map((part) => `<collision>${mesh(part.name)}</collision>`),
  ];
  return robot(name, lines);
}

/** MuJoCo 3 drops the folder of every mesh unless it is told otherwise; other programs pass over this. */
const keepFolders = `<mujoco><compiler strippath="false"/></mujoco>`;

const plate = `<origin xyz="0 0 -0.5" rpy="0 0 0"/><geometry><box size="10 10 1"/></geometry>`;
const ground = robot("ground", [
  contact,
  `<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>`,
  `<visual>${plate}<material name="grey"><color rgba="0.8 0.82 0.84 1"/></material></visual>`,
  `<collision>${plate}</collision>`,
]);

function robot(name: string, lines: readonly string[]): string {
  return `<?xml version="1.0"?>\n<!-- ${GENERATOR} -->\n<robot name="${name}">\n  ${keepFolders}\n  <link name="${name}">\n${lines.map((line) => `    ${line}\n`).join("")}  </link>\n</robot>\n`;
}
