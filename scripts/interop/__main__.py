"""`python -m interop truth.write ROOT` writes the known object, `checks.check ROOT ROWS` compares what was read and loaded.

`cells.run ROOT NAME JOB` lets a program do its job: files to write, and ours to load. Each environment has what its part needs.
"""

import importlib
import sys

room, function = sys.argv[1].split(".")
getattr(importlib.import_module(f".{room}", __package__), function)(*sys.argv[2:])
