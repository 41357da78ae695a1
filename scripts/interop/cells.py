"""Cells of the matrix: a variant of what a program writes, or of what it loads; and the known object (see `truth.py`)."""

import importlib.metadata
import json
import os
import re

import numpy as np

from .truth import light

# Programs by what they do: (`write`, `load` or `place`, name) -> (distribution, function).
PROGRAMS = {}


def program(name, action="write", distribution=None):
    def register(function):
        PROGRAMS[action, name] = (distribution or name, function)
        return function

    return register


class Truth:
    def __init__(self, folder):
        with open(os.path.join(folder, "truth.json")) as file:
            known = json.load(file)
        self.points = np.array(known["points"])
        self.triangles = np.array(known["triangles"], np.int32)
        self.colors = np.array(known["colors"], np.uint8)
        self.uv = np.array(known["uv"])
        self.volume = known["volume"]
        self.texture = os.path.join(folder, "texture.png")
        self.width, self.height = known["camera"]["width"], known["camera"]["height"]
        self.fx, self.fy, self.cx, self.cy = (known["camera"][key] for key in ("fx", "fy", "cx", "cy"))
        self.K = np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])
        self.quaternion, self.translation = np.array(known["pose"]["rotation"]), np.array(known["pose"]["translation"])
        shape = (self.height, self.width)
        self.depth = np.fromfile(os.path.join(folder, "depth.f32"), np.float32).reshape(shape)
        self.mask = np.fromfile(os.path.join(folder, "mask.u8"), np.uint8).reshape(shape)
        self.mm = np.round(self.depth * 1000).astype(np.uint16)
        self.face_colors = np.round(self.colors[self.triangles].mean(1)).astype(np.uint8)
        self.linear = light(self.colors)

    def matrix(self):
        """OpenCV camera from body."""
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = rotation(self.quaternion), self.translation
        return pose


def rotation(xyzw):
    x, y, z, w = np.asarray(xyzw, float) / np.linalg.norm(xyzw)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Cells:
    def __init__(self, name, distribution, out, truth):
        self.name, self.truth, self.rows = name, truth, []
        self.version = importlib.metadata.version(distribution)
        self.folder = os.path.join(out, f"{name}-{self.version}".replace(" ", "-"))

    def write(self, kind, variant, file, action, **expect):
        """A file that `action(path)` writes. What a program cannot write is a row of its own, and no cell."""
        folder = os.path.join(self.folder, re.sub(r"\W+", "-", f"{kind} {variant}"))
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, file)
        row = {"program": self.name, "version": self.version, "action": "write", "kind": kind, "variant": variant, "file": path}
        try:
            action(path)
            row["expect"] = expect
        except Exception as error:
            row["notWritten"] = f"{type(error).__name__}: {error}"[:300]
        self.rows.append(row)

    def measure(self, kind, variant, action, limit):
        """How far what `action()` loads is from the truth: a number, or several, in the unit of the limit."""
        row = {"program": self.name, "version": self.version, "kind": kind, "variant": variant, "limit": limit}
        try:
            row["error"] = float(np.max(np.abs(np.asarray(action(), float))))
        except Exception as error:
            row["failed"] = f"{type(error).__name__}: {error}"[:300]
        self.rows.append(row)

    def place(self, question, what, action, expected, limit=1e-6):
        """What a program does in a place where programs differ: a number, which is to be the expected one."""
        found = []
        self.measure(question, what, lambda: found.append(float(action())) or found[0] - expected, limit)
        self.rows[-1]["found"] = (found or [None])[0]


def farthest(points, others):
    """The largest distance from a point to the nearest of the others, both ways."""
    points, others = np.asarray(points, float), np.asarray(others, float)
    distances = np.linalg.norm(points[:, None] - others[None], axis=2)
    return max(distances.min(1).max(), distances.min(0).max())
