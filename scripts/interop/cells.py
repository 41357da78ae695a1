"""What a program of Python does: it writes the files of its job, and tells what it found in ours."""

import importlib
import json
import os
from pydoc import locate

import numpy as np

from .truth import Truth

# OpenCV's axes from OpenGL's, and from those of ROS.
FLIP = np.diag([1.0, -1, -1, 1])
ROS = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])


def dump(path, content):
    with open(path, "w") as file:
        json.dump(content, file, default=lambda each: each.decode() if isinstance(each, bytes) else np.asarray(each).tolist())


class Cells:
    """The files that a program is to write, each by a call of one of its writers, and the facts that it finds."""

    def __init__(self, t, writes):
        self.t, self.waiting, self.failed, self.found = t, writes, {}, {}

    def argument(self, value):
        """What stands in a call: `["=numpy.log", …]` is a result, `$cv2.INTER_AREA` what a package has, `$depth:f2` the array `depth` as
        half floats, `$path` the file to write, `$ours/placed.ply` a file of ours."""
        if isinstance(value, dict):
            return {name: self.argument(each) for name, each in value.items()}
        if isinstance(value, list) and str(value[:1]).startswith("['="):
            return self.call(locate(value[0][1:]), value[1:])
        if isinstance(value, list):
            return [self.argument(each) for each in value]
        if not (isinstance(value, str) and value.startswith("$")):
            return value

        name, _, kind = value[1:].partition(":")
        if name.startswith("ours/"):
            return os.path.join(self.t.root, name)
        found = locate(name) if "." in name else getattr(self.t, name)
        return found.astype(kind) if kind else found

    def call(self, function, arguments):
        """The result of a function; its last argument in a table may be its `options`, by their names."""
        last = arguments[-1] if arguments else None
        options = last["options"] if isinstance(last, dict) and "options" in last else {}
        given = arguments[:-1] if options else arguments
        return function(*self.argument(given), **self.argument(options))

    def writes(self, **writers):
        """Writes the files of these writers, and of functions of packages: `writer(path, *arguments, **options)`."""
        for path, (name, *arguments) in list(self.waiting.items()):
            writer = locate(name) if "." in name else writers.get(name)
            if writer is None:
                continue

            del self.waiting[path]
            os.makedirs(os.path.dirname(path), exist_ok=True)
            self.t.path = path
            try:
                done = self.call(writer, arguments if "$path" in str(arguments) else ["$path", *arguments])
                assert done is not False, f"{name} returned False"
            except Exception as error:
                self.failed[path] = f"{type(error).__name__}: {error}"[:300]

    def loads(self, of, **facts):
        """What was found in files of ours of a kind, or in a place where programs differ, by the names of `loads.json`."""
        self.found.setdefault(of, {}).update(facts)

    def meshes(self, load):
        """What a program sees in our meshes: `load(path)` returns the vertices in the world of the file."""
        for name in ("node", "baked", "textured", "scene-camera", "node-opencv", "scene"):
            self.loads("GLB", **{name: load(self.t.ours(f"{name}.glb"))})
        self.loads("PLY", placed=load(self.t.ours("placed.ply")))


def run(root, name, job):
    """All of a program: its function, and what the tables say alone. Where it fails, its other cells say why."""
    with open(job) as file:
        asked = json.load(file)
    t = Truth(root)
    cells, why = Cells(t, asked["writes"]), "the program did not do it"
    rooms = [importlib.import_module(f".{each}", __package__) for each in ("cameras", "loads", "meshes", "pictures")]
    functions = [vars(room).get(name.lower().replace(" ", "_").replace("-", "_")) for room in rooms]
    try:
        for function in filter(None, functions):
            function(cells, t)
        cells.writes(dump=dump)
        for kind, fact, function, *arguments in asked["facts"]:
            cells.loads(kind, **{fact: cells.call(locate(function), arguments)})
    except Exception as error:
        why = f"{type(error).__name__}: {error}"[:300]
    dump(job, {"failed": cells.failed, "found": cells.found, "why": why})
