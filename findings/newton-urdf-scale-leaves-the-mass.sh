#!/usr/bin/env bash
# Newton: add_urdf with a scale changes the inertia and not the mass.
#
# One would expect: scale=2 gives a body twice as large in every direction. Of the same material it has 8 times the mass and 32 times
# the inertia; if the file's numbers are kept, both stay.
#
# What happens: the mass stays, the inertia is multiplied by 4, the square of the scale: a larger body of the same mass, so of an eighth
# of the density. Nothing is printed. For scale 0.001, a URDF in millimetres, the inertia is a millionth of what the file says,
# even if the file has mass and inertia in kg and kg m^2 already.
#
# Versions: newton 1.8.0, warp-lang 1.19.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: the size of a generated mesh is only known after it was placed by depth, and a scale argument is the obvious way
# to hand it over. An object of half its size keeps its weight: grippers and stacks behave as if it were of lead.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet newton==1.8.0 warp-lang==1.19.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import newton
import numpy as np
import warp

warp.config.quiet = True
inertia = '<inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial>'
box = '<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
with open("box.urdf", "w") as file:
    file.write(f'<robot name="box"><link name="box">{inertia}{box}</link></robot>')


def loaded(scale):
    builder = newton.ModelBuilder()
    builder.add_urdf("box.urdf", floating=True, scale=scale)
    return float(builder.body_mass[0]), np.array(builder.body_inertia[0]).reshape(3, 3)[0, 0], np.array(builder.shape_scale[0])


(mass, moment, half), (mass2, moment2, half2) = loaded(1.0), loaded(2.0)
print(f"newton {newton.__version__}: scale 1: half sizes {half}, mass {mass}, ixx {moment:.3f}; scale 2: {half2}, mass {mass2}, ixx {moment2:.3f}")
assert np.allclose(half2, 2 * half) and mass2 == mass and abs(moment2 / moment - 4) < 1e-5, "the behaviour has changed"
PYTHON
