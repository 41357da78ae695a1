#!/usr/bin/env bash
# A URDF of one link is a free body in PyBullet, and part of the world without mass in MuJoCo.
#
# One would expect: a URDF with a single link, the usual file for an object that a robot picks up, is the same thing in two
# simulators: both read URDF, and the file has mass and inertia.
#
# What happens: PyBullet makes it a free body of its mass. MuJoCo welds the first link of a URDF to the world: no body, no joint, total
# mass 0, its geometry belongs to the world and does not fall. No error and no warning. In MuJoCo a URDF needs a second link and a
# floating joint, or a freejoint added to the model by hand (MjSpec).
#
# Versions: mujoco 4.0.0 (3.3.7 is the same), pybullet 3.2.7, numpy 2.4.6, Python 3.11.
#
# Why it matters: placed objects are handed to simulators as one URDF each. In MuJoCo the scene looks right and nothing moves,
# so it passes for one in which everything rests well; a gripper finds objects that cannot be lifted.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet mujoco==4.0.0 pybullet==3.2.7 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import importlib.metadata

import mujoco
import pybullet

box = '<origin xyz="0 0 0"/><geometry><box size="0.17 0.09 0.05"/></geometry>'
inertia = '<mass value="0.3"/><inertia ixx="0.0003" ixy="0" ixz="0" iyy="0.0008" iyz="0" izz="0.0009"/>'
with open("box.urdf", "w") as file:
    file.write(f'<robot name="box"><link name="box"><inertial>{inertia}</inertial><collision>{box}</collision></link></robot>')

pybullet.connect(pybullet.DIRECT)
pybullet.setGravity(0, 0, -9.81)
body = pybullet.loadURDF("box.urdf", [0, 0, 1])
for _ in range(60):
    pybullet.stepSimulation()
mass, fallen = pybullet.getDynamicsInfo(body, -1)[0], 1 - pybullet.getBasePositionAndOrientation(body)[0][2]
print(f"pybullet {importlib.metadata.version('pybullet')}: mass {mass} kg, fell {fallen:.2f} m in a quarter of a second")

model = mujoco.MjModel.from_xml_path("box.urdf")
total = float(model.body_mass.sum())
print(f"mujoco {mujoco.__version__}: {model.nbody - 1} bodies, {model.njnt} joints, mass {total} kg, the box belongs to body {model.geom_bodyid[0]}, the world")
assert mass == 0.3 and fallen > 0.2 and model.nbody == 1 and total == 0 and model.ngeom == 1, "the behaviour has changed"
PYTHON
