#!/usr/bin/env bash
# SciPy: ndimage.zoom(depth, 0.5) does not halve the focal length, and its pixels drift by half a pixel to each side.
#
# One would expect: a depth map of 640 x 480, zoomed by 0.5, is a picture of half the size: K is halved (with half a pixel of
# care), as for cv2.resize, Pillow and skimage.
#
# What happens: zoom maps the centre of the first pixel to the first and that of the last to the last. From 12 pixels, the six
# are those at 0, 2.2, 4.4, 6.6, 8.8 and 11, not 0.5, 2.5 ... 10.5. The true factor is (new - 1) / (old - 1): for 640 -> 320 it is
# 0.49922, and no choice of cx makes up for it: with the halved K points are right on one column and off by half a pixel of the
# original on either edge, in opposite directions. The option grid_mode=True (with mode="nearest") does what one expects.
#
# Versions: scipy 1.17.1, numpy 2.4.6, Python 3.11.
#
# Why it matters: order=0 is advised for depth, as it makes no flying pixels, and zoom(depth, factor, order=0) is the shortest
# line for it. Objects at the edges move outwards against those in the middle, 0.8 mm at 1 m for fx = 600, growing with the factor:
# 3 mm for 1/8.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet scipy==1.17.1 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import scipy
from scipy.ndimage import zoom

row = lambda n, factor, **options: zoom(np.arange(float(n))[None].repeat(n, 0), factor, **options)[0]
print(f"scipy {scipy.__version__}: columns 0 to 11 by 0.5, order 1: {np.round(row(12, 0.5, order=1), 2)}")
print(f"with grid_mode: {np.round(row(12, 0.5, order=1, grid_mode=True, mode='nearest'), 2)}")
for part in (2, 8):
    columns = row(640, 1 / part, order=1)
    # Where a halved K puts them: the middle of the pixels that each stands for.
    believed = (np.arange(len(columns)) + 0.5) * part - 0.5
    off = columns - believed
    print(f"640 by 1/{part}: off by {off[0]:.2f} pixels on the left, {off[-1]:.2f} on the right")
    assert abs(off[0] + (part - 1) / 2) < 0.01 and abs(off[-1] - (part - 1) / 2) < 0.01, "the behaviour has changed"
assert np.allclose(row(12, 0.5, order=1), np.linspace(0, 11, 6)), "the behaviour has changed"
PYTHON
