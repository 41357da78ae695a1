#!/usr/bin/env bash
# PyBullet: the software renderer of getCameraImage looks through the lower left corner of each pixel, not through its centre.
#
# One would expect: with the projection matrix of a camera whose optical axis is in the middle of the picture, pixel (u, v) shows the
# ray through (u + 0.5, v + 0.5), as in OpenGL, whose matrices PyBullet takes. In OpenCV's numbers: cx = width / 2 - 0.5, cy = height / 2 - 0.5.
#
# What happens with ER_TINY_RENDERER, the renderer of machines without a display: the depth of pixel (u, v), made linear with near and
# far, is that of the ray through (u, v + 1), to a few micrometres: half a pixel to the left and half a pixel down. That is
# cx = width / 2 and cy = height / 2 - 1.
#
# Versions: pybullet 3.2.7, numpy 2.4.6, Python 3.11.
#
# Why it matters: depth, masks and boxes rendered in this way are the ground truth of many tests of pose and placement. Points
# back-projected with the usual K are off by half a pixel in x and in y, in opposite directions: 1.2 mm at 1 m for f = 600, far above the noise
# of a good method; on slanted surfaces, the depth itself seems wrong, here by up to 1.8 mm.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pybullet==3.2.7 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import importlib.metadata

import numpy as np
import pybullet

width, height, f, near, far = 160, 120, 150.0, 0.1, 3.0
pybullet.connect(pybullet.DIRECT)
# A slanted wall, z = 1 + 0.5 x + 0.3 y, in a camera that looks along -z with y up.
corners = [(x, y, 1 + 0.5 * x + 0.3 * y) for x, y in ((-2, -2), (2, -2), (2, 2), (-2, 2))]
vertices = [[x, -y, -z] for x, y, z in corners]
wall = pybullet.createVisualShape(pybullet.GEOM_MESH, vertices=vertices, indices=[0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2])
pybullet.createMultiBody(0, -1, wall)
projection = np.zeros((4, 4))
projection[0, 0], projection[1, 1] = 2 * f / width, 2 * f / height
projection[2, 2], projection[2, 3], projection[3, 2] = -(far + near) / (far - near), -2 * far * near / (far - near), -1
view, lens = np.eye(4).ravel().tolist(), projection.T.ravel().tolist()
image = pybullet.getCameraImage(width, height, view, lens, renderer=pybullet.ER_TINY_RENDERER)
buffer = np.asarray(image[3], float).reshape(height, width)
depth = far * near / (far - buffer * (far - near))
u, v = np.meshgrid(np.arange(width), np.arange(height))


def error(right, down):
    """The largest difference from the wall, if pixel (u, v) shows the ray through (u + right, v + down)."""
    x, y = (u + right - width / 2) / f, (v + down - height / 2) / f
    return float(np.abs(depth - 1 / (1 - 0.5 * x - 0.3 * y)).max())


print(f"pybullet {importlib.metadata.version('pybullet')}: largest error in depth for rays through")
for name, right, down in (("centres", 0.5, 0.5), ("upper left corners", 0, 0), ("lower left corners", 0, 1)):
    print(f"  {name}: {1000 * error(right, down):.3f} mm")
assert error(0, 1) < 2e-5 and error(0.5, 0.5) > 1e-3, "the behaviour has changed"
PYTHON
