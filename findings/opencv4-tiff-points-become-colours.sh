#!/usr/bin/env bash
# OpenCV 4: a point map that imwrite saves as TIFF comes back bent, with a part of its points at 0, 0, 0.
#
# One would expect: cv2.imwrite("points.tiff", xyz) with float32 of H x W x 3 stores the numbers, as it does for one channel of
# float32 (a depth map) and for three channels of float64.
#
# What happens: three channels of float32 are taken for a picture with a high range, and are stored as LogLuv, a lossy code for
# colours (compression SGI LogLuv 24, photometric interpretation 32845). Where the "colour" is darker than black, which is a matter of
# the signs of x and y, all three numbers become 0; elsewhere they change, by up to their whole size. imwrite returns True, and
# imread gives float32 of the right shape back. OpenCV 5 stores the numbers.
#
# Versions: opencv-python-headless 4.12.0.88 and 5.0.0.93, numpy 2.2.6, Python 3.11.
#
# Why it matters: maps of points (x, y, z for each pixel) come out of depth models and stereo, and TIFF is the usual file for
# float depth. x is negative left of the middle, y above it: after the file a part of the scene is at the camera's centre, which
# passes for "no reading", and what is left is bent. Use numpy.save, or float64.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
check() {
  python3 -m venv "$folder/$1"
  "$folder/$1/bin/pip" install --quiet "opencv-python-headless==$1" numpy==2.2.6
  "$folder/$1/bin/python" - "$folder/points.tiff" "$2" <<'PYTHON'
import sys

import cv2
import numpy as np

path, is_lossy = sys.argv[1], sys.argv[2] == "lossy"
u, v = np.meshgrid(np.arange(64), np.arange(48))
z = np.full((48, 64), 0.8)
points = np.stack([(u - 31.5) / 60 * z, (v - 23.5) / 60 * z, z], 2).astype(np.float32)
for name, array in (("float32", points), ("float64", points.astype(float)), ("one channel", points[..., 0])):
    assert cv2.imwrite(path, array)
    back = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    assert back.shape == array.shape and back.dtype == array.dtype
    lost, error = int((back == 0).all(2).sum()) if array.ndim == 3 else 0, float(np.abs(array - back).max())
    print(f"opencv {cv2.__version__}, {name}: {lost} of {z.size} points became 0, 0, 0; largest error {error:.3f} m")
    if is_lossy and name == "float32":
        kept = ~(back == 0).all(2)
        print(f"  of the others, the largest error is {np.abs(array - back)[kept].max():.3f} m")
        assert lost > z.size // 10 and np.abs(array - back)[kept].max() > 0.02, "the behaviour has changed"
    else:
        assert error == 0 and lost == 0, "the behaviour has changed"
PYTHON
}
check 4.12.0.88 lossy
check 5.0.0.93 exact
