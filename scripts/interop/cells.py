"""What a program of Python does: it writes the files of its job, and tells what it found in ours."""

import importlib
import json
import os

import numpy as np

from .truth import Truth

# OpenCV's axes from OpenGL's.
FLIP = np.diag([1.0, -1, -1, 1])


def dump(path, content, drawn=None):
    """Writes JSON, and of a polygon the mask that its program draws."""
    with open(path, "w") as file:
        json.dump(content, file, default=lambda each: each.decode() if isinstance(each, bytes) else np.asarray(each).tolist())
    if drawn is not None:
        np.save(os.path.join(os.path.dirname(path), "expected.npy"), drawn.astype(np.uint8))


def function(name):
    """A function of a package: `numpy.save`."""
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


class Cells:
    """The files that a program is to write, each by a call of one of its writers, and the facts that it finds."""

    def __init__(self, t, version, writes):
        self.t, self.version, self.waiting, self.failed, self.found = t, version, writes, {}, {}

    def argument(self, value):
        """What stands in a call: `$depth:f2` is the array `depth` as half floats, `{"call": ["numpy.log", …]}` a result."""
        if isinstance(value, list):
            return [self.argument(each) for each in value]
        if isinstance(value, dict):
            inner = {name: self.argument(each) for name, each in value.items()}
            return function(inner["call"][0])(*inner["call"][1:]) if "call" in inner else inner
        if not (isinstance(value, str) and value.startswith("$")):
            return value

        name, _, kind = value[1:].partition(":")
        array = getattr(self.t, name)
        return array.astype(kind) if kind else array

    def writes(self, **writers):
        """Writes the files of these writers: `writer(path, *arguments, **options)`."""
        for path, (name, options, *arguments) in list(self.waiting.items()):
            if name not in writers and "." not in name:
                continue

            del self.waiting[path]
            os.makedirs(os.path.dirname(path), exist_ok=True)
            try:
                write = writers.get(name) or function(name)
                write(path, *self.argument(arguments), **self.argument(options))
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
    """All of a program: its files without code of their own, then its function. Where it fails, its other cells say why."""
    with open(job) as file:
        asked = json.load(file)
    t = Truth(root)
    cells, why = Cells(t, asked["version"], asked["writes"]), "the program did not do it"
    rooms = [importlib.import_module(f".{each}", __package__) for each in ("cameras", "depths", "loads", "masks", "meshes")]
    functions = [vars(room).get(name.lower().replace(" ", "_").replace("-", "_")) for room in rooms]
    try:
        cells.writes(dump=dump)
        for function in filter(None, functions):
            function(cells, t)
    except Exception as error:
        why = f"{type(error).__name__}: {error}"[:300]
    dump(job, {"failed": dict.fromkeys(cells.waiting, why) | cells.failed, "found": cells.found, "why": why})
