#!/usr/bin/env bash
# Pillow 13: depth in int32 can no longer be saved as PNG; up to version 12 it was a 16-bit PNG.
#
# One would expect: Image.fromarray((1000 * depth).astype(np.int32)).save("depth.png"), the line by which many scripts and
# datasets wrote millimetres because older versions could not save uint16 in mode "I;16" everywhere, works on.
#
# What happens: up to Pillow 12, mode "I" was written as a 16-bit grey PNG (numbers above 65535 clipped or wrapped without a word).
# Pillow 13 raises OSError "cannot write mode I as PNG". Arrays of uint16 are mode "I;16" and are written as before. Reading a
# 16-bit PNG gives mode "I;16" in both.
#
# Versions: pillow 12.3.0 and 13.0.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: the writer fails after the rendering or the recording, at the end of a run. Cast to uint16, after a check that
# nothing is farther than 65.535 m.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for version in 12.3.0 13.0.0; do
  python3 -m venv "$folder/$version"
  "$folder/$version/bin/pip" install --quiet "pillow==$version" numpy==2.4.6
  "$folder/$version/bin/python" - "$folder/depth.png" <<'PYTHON'
import sys

import numpy as np
import PIL
from PIL import Image

path, millimetres = sys.argv[1], np.array([[0, 500], [2500, 40000]])
outcomes = []
for kind in (np.int32, np.uint16):
    try:
        Image.fromarray(millimetres.astype(kind)).save(path)
        back = Image.open(path)
        outcomes.append(f"mode {back.mode}, {np.asarray(back).ravel().tolist()}")
    except OSError as error:
        outcomes.append(str(error))
print(f"pillow {PIL.__version__}: int32: {outcomes[0]}; uint16: {outcomes[1]}")
works = "[0, 500, 2500, 40000]" in outcomes[0]
assert works == PIL.__version__.startswith("12") and "[0, 500, 2500, 40000]" in outcomes[1], "the behaviour has changed"
PYTHON
done
