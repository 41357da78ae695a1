#!/usr/bin/env bash
# Newton: a floating body of a URDF is at the origin in the state, wherever add_urdf was told to put it.
#
# One would expect: after builder.add_urdf(path, xform=pose, floating=True), builder.finalize() and model.state(), the body is at
# `pose`: state.body_q says where bodies are, and it does so for builder.add_body(xform=pose), in the same model.
#
# What happens: the pose goes into the coordinates of the free joint (joint_q) alone. body_q, in the builder and in the first
# state, is the identity until eval_fk(model, model.joint_q, model.joint_qd, state) was called. Solvers of joint coordinates start at the
# pose, what reads body_q (viewers, sensors, contacts of the first step) sees all URDF bodies in one heap at the origin.
#
# Versions: newton 1.8.0, warp-lang 1.19.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: a scene of placed objects is one URDF each, with its pose as xform. A check of the poses right after loading
# says that nothing was placed.
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
inertia = '<inertial><mass value="0.3"/><inertia ixx="0.0003" ixy="0" ixz="0" iyy="0.0008" iyz="0" izz="0.0009"/></inertial>'
box = '<collision><geometry><box size="0.17 0.09 0.05"/></geometry></collision>'
with open("box.urdf", "w") as file:
    file.write(f'<robot name="box"><link name="box">{inertia}{box}</link></robot>')
pose = warp.transform((1.0, 2.0, 3.0), warp.quat_identity())
builder = newton.ModelBuilder()
builder.add_urdf("box.urdf", xform=pose, floating=True)
builder.add_body(xform=pose, mass=0.3)
model = builder.finalize()
state = model.state()
urdf, other = state.body_q.numpy()[:, :3].copy()
newton.eval_fk(model, model.joint_q, model.joint_qd, state)
after = state.body_q.numpy()[0, :3]
print(f"newton {newton.__version__}: body of the URDF at {urdf}, of add_body at {other}; after eval_fk at {after}")
assert np.all(urdf == 0) and np.all(other == [1, 2, 3]) and np.all(after == [1, 2, 3]), "the behaviour has changed"
PYTHON
