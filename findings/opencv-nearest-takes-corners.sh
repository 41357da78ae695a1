#!/usr/bin/env bash
# OpenCV: INTER_NEAREST takes the upper left pixel of each block, not the one in its middle.
#
# One would expect: cv2.resize(depth, None, fx=1/3, fy=1/3, interpolation=cv2.INTER_NEAREST), the usual advice for depth and
# masks, takes the pixel nearest to the middle of each new pixel: columns 1, 4, 7, ... as INTER_LINEAR and INTER_AREA, whose
# results it is laid over, are centred there, and as Pillow does.
#
# What happens: it takes columns 0, 3, 6: floor(i * 3) without the half pixel. Everything moves by (m - 1) / 2 pixels of the
# original for a reduction by m, against the colours that were reduced with INTER_AREA and against a K that was scaled. INTER_
# NEAREST_EXACT (since 4.5) takes the middle. The same for odd factors of enlargement.
#
# Versions: opencv-python-headless 5.0.0.93, pillow 13.0.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: depth of 1280 x 720 that is reduced by 4 moves by one and a half pixels of the original: 1.7 mm at 1 m for a
# focal length of 900, for every object in the same direction; by 8, 3.9 mm. A mask drawn on the small colour picture and the small
# depth then disagree along all left and upper edges, where the background leaks in.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet opencv-python-headless==5.0.0.93 pillow==13.0.0 numpy==2.4.6
"$folder/venv/bin/python" - <<'PYTHON'
import cv2
import numpy as np
from PIL import Image

columns = np.arange(24, dtype=np.float32)[None].repeat(24, 0)
for m in (3, 4, 8):
    size = (24 // m, 24 // m)
    flags = {name: getattr(cv2, f"INTER_{name}") for name in ("NEAREST", "NEAREST_EXACT", "LINEAR", "AREA")}
    first = {name: float(cv2.resize(columns, size, interpolation=flag)[0, 0]) for name, flag in flags.items()}
    pillow = float(np.asarray(Image.fromarray(columns).resize(size, Image.Resampling.NEAREST))[0, 0])
    print(f"opencv {cv2.__version__}, reduced by {m}: the first column comes from {first}, Pillow's from {pillow}")
    assert first["NEAREST"] == 0 and first["AREA"] == (m - 1) / 2 and abs(pillow - (m - 1) / 2) <= 0.5, "the behaviour has changed"
    assert abs(first["NEAREST_EXACT"] - (m - 1) / 2) <= 0.5 and abs(first["LINEAR"] - (m - 1) / 2) < 1e-3, "the behaviour has changed"
PYTHON
