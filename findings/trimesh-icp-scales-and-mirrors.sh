#!/usr/bin/env bash
# trimesh: registration.icp scales and mirrors by default, so a mesh shrinks onto a scan of its visible side.
#
# One would expect: iterative closest points without options finds a rigid motion, as in the literature and in Open3D, PCL and
# PyMeshLab; scale and reflection are what one asks for.
#
# What happens: each step is procrustes(), whose defaults are scale=True and reflection=True, and icp() has no options of its own
# for them (they go through **kwargs). Two effects, both silent: a whole box that starts at its true pose, registered to the half
# of its surface that a camera sees, comes out smaller; and points whose mirror image fits get a matrix with a negative
# determinant, which is no motion of a body. With scale=False, reflection=False both are right.
#
# Versions: trimesh 5.2.0, scipy 1.17.1, rtree 1.4.1, numpy 2.4.6, Python 3.11.
#
# Why it matters: it is the nearest ICP for who has the mesh in trimesh already. A size that was known before is changed by a few
# per cent, the residual looks better for it, and code that takes a quaternion of the result gets one of a matrix that is no
# rotation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet trimesh==5.2.0 scipy==1.17.1 rtree==1.4.1 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import trimesh
from trimesh.registration import icp

box = trimesh.creation.box([0.17, 0.09, 0.05])
for _ in range(4):
    box = box.subdivide()
# The two faces that a camera sees.
seen = box.vertices[(box.vertices[:, 2] > 0.0249) | (box.vertices[:, 0] > 0.0849)]
rigid = {"scale": False, "reflection": False}
size = lambda options: np.cbrt(np.linalg.det(icp(box.vertices, seen, max_iterations=50, **options)[0][:3, :3]))
free, fixed = size({}), size(rigid)
print(f"trimesh {trimesh.__version__}: scale of the box on its visible half: {free:.4f} by default, {fixed:.4f} with {rigid}")

points = np.random.default_rng(0).uniform(-1, 1, (200, 3)) * [3, 2, 0.02]
sign = lambda options: np.linalg.det(icp(points, points * [1, 1, -1], max_iterations=50, **options)[0][:3, :3])
mirrored, kept = sign({}), sign(rigid)
print(f"determinant for points and their mirror image: {mirrored:.3f} by default, {kept:.3f} with {rigid}")
assert free < 0.995 and abs(fixed - 1) < 1e-9 and mirrored < 0 < kept, "the behaviour has changed"
PYTHON
