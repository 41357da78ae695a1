"""`python -m interop list` names the programs whose packages are installed; `write` and `load` run one: ACTION NAME ROOT OUT.

`truth ROOT` writes the known object, `check ROOT` compares what our readers returned.
"""

import importlib
import importlib.metadata
import json
import os
import sys

from . import cells, checks, truth

for module in ("meshes", "depths", "masks", "cameras", "loads", "places"):
    importlib.import_module(f".{module}", __package__)

if sys.argv[1] == "list":
    for (action, name), (distribution, _) in cells.PROGRAMS.items():
        try:
            importlib.metadata.version(distribution)
        except importlib.metadata.PackageNotFoundError:
            continue
        print(action, name, sep="\t")
elif sys.argv[1] == "truth":
    truth.write(os.path.join(sys.argv[2], "truth"))
elif sys.argv[1] == "check":
    checks.check(sys.argv[2])
else:
    action, name, root, out = sys.argv[1:5]
    distribution, function = cells.PROGRAMS[action, name]
    known = cells.Truth(os.path.join(root, "truth"))
    found = cells.Cells(name, distribution, os.path.join(root, "files"), known)
    function(found, known, *([os.path.join(root, "ours")] if action == "load" else []))
    with open(out, "w") as file:
        json.dump(found.rows, file)
