"""`python -m interop truth ROOT` writes the known object, `check ROOT` compares what our readers returned.

`run ROOT NAME VERSION OUT` runs a program.
"""

import sys

from . import cells, checks, truth
from . import cameras, depths, loads, masks, meshes  # noqa: F401

action, root, *rest = sys.argv[1:]
if action == "truth":
    truth.write(root)
elif action == "check":
    checks.check(root)
else:
    name, version, out = rest
    found = cells.Cells(name, version, root)
    found.run(cells.Truth(root))
    cells.dump(out, found.rows)
