#!/usr/bin/env bash
# MuJoCo: a camera's principalpixel moves the principal point to the left, and since 3.6.0 up instead of down.
#
# One would expect: principalpixel="20 30", an offset of the principal point from the centre of the image in pixels, puts it
# where OpenCV's cx and cy would be, 20 pixels to the right and 30 down: at (340, 270) of 640 x 480. Or, in the axes of
# MuJoCo's cameras (x right, y up), at (340, 210). And that one file means the same in all versions.
#
# What happens: up to 3.5.0 it is at (300, 270), to the left and down. From 3.6.0 to 4.0.0 it is at (300, 210), to the left and
# up, as on a sensor behind the lens, where the image stands on its head. The frustum of the scene shows it. Nothing is
# printed, and with offsets of a few pixels both pictures look right.
#
# Versions: mujoco 3.5.0, 3.6.0 and 4.0.0, Python 3.11.
#
# Why it matters: depth cameras have principal points ten or twenty pixels off the centre. A scene that was made of a depth map
# is then rendered twice that far beside it: 3 cm per metre for 10 pixels and a focal length of 600. Offsets of OpenCV's
# intrinsics for MuJoCo from 3.6.0 on are (width / 2 - (cx + 0.5), height / 2 - (cy + 0.5)); before, the second one has the
# opposite sign.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
check() {
  python3 -m venv "$folder/$1"
  "$folder/$1/bin/pip" install --quiet "$1"
  "$folder/$1/bin/python" - "$2" <<'PYTHON'
import sys

import mujoco

width, height = 640, 480
model = mujoco.MjModel.from_xml_string(
    f"""<mujoco><worldbody>
    <camera name="c" resolution="{width} {height}" sensorsize="0.64 0.48" focalpixel="600 600" principalpixel="20 30"/>
    <geom type="sphere" size="0.1" pos="0 0 -2"/>
    </worldbody></mujoco>"""
)
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
scene, camera = mujoco.MjvScene(model, 10), mujoco.MjvCamera()
camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
every = mujoco.mjtCatBit.mjCAT_ALL
mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), mujoco.MjvPerturb(), camera, every, scene)
seen = scene.camera[0]
left, right = seen.frustum_center - seen.frustum_width, seen.frustum_center + seen.frustum_width
across = -left / (right - left) * width
down = seen.frustum_top / (seen.frustum_top - seen.frustum_bottom) * height
print(f"mujoco {mujoco.__version__}: principalpixel (20, 30) of {width} x {height}: ({across:.1f}, {down:.1f}) from the top left")
assert abs(across - 300) < 0.1 and abs(down - float(sys.argv[1])) < 0.1, "the behaviour has changed"
PYTHON
}
check mujoco==3.5.0 270
check mujoco==3.6.0 210
check mujoco==4.0.0 210
