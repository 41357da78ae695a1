#!/usr/bin/env bash
# SAPIEN: URDFLoader.load refuses a URDF of one link, and says that it contains several objects.
#
# One would expect: loader.load("box.urdf") returns the object of a file that describes one rigid body; or an error that says what
# is the matter.
#
# What happens: a link without joints becomes an actor, not an articulation, and load() accepts only files with exactly one
# articulation. One link and no joint: "URDF contains multiple objects, call load_multiple instead". load_multiple does return it, as
# ([], [actor]). A second, empty link with a fixed joint makes load() work, and the same body an articulation.
#
# Versions: sapien 3.0.3, numpy 2.4.6, Python 3.11.
#
# Why it matters: one URDF with one link is what exporters write for an object that was placed by depth. Scripts written for
# robots fail on it with a message that sends one looking for a second object in the file.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet sapien==3.0.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON' 2>/dev/null
import importlib.metadata

import sapien

box = '<collision><geometry><box size="0.17 0.09 0.05"/></geometry></collision>'
inertia = '<inertial><mass value="0.3"/><inertia ixx="0.0003" ixy="0" ixz="0" iyy="0.0008" iyz="0" izz="0.0009"/></inertial>'
link = f'<link name="box">{inertia}{box}</link>'
second = '<link name="tip"/><joint name="j" type="fixed"><parent link="box"/><child link="tip"/></joint>'
for name, text in (("one.urdf", link), ("two.urdf", link + second)):
    with open(name, "w") as file:
        file.write(f'<robot name="box">{text}</robot>')
scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
loader = scene.create_urdf_loader()
loader.fix_root_link = False
message = "none"
try:
    loader.load("one.urdf")
except Exception as error:
    message = str(error)
articulations, actors = loader.load_multiple("one.urdf")[:2]
print(f"sapien {importlib.metadata.version('sapien')}: load of one link: {message}")
print(f"load_multiple: {len(articulations)} articulations, {len(actors)} actor; load with a second, empty link: {type(loader.load('two.urdf')).__name__}")
assert "multiple objects" in message and len(articulations) == 0 and len(actors) == 1, "the behaviour has changed"
PYTHON
