"""Programs, the cells of the matrix that they fill, and the known object (see `truth.py`)."""

import json
import os
import re

import numpy as np

from .truth import light, rotation

# What each program does, by its name in `packages.json`.
PROGRAMS = {}
# OpenCV's axes from OpenGL's.
FLIP = np.diag([1.0, -1, -1, 1])
# Floats of 32 bits, and numbers of 7 digits, at half a metre.
LIMIT = 1e-6
# Of depth that is rounded to millimetres.
MM = {"limitM": 0.0005001}
# Converted by another program first, as our error says.
REFUSED = {"refused": "UNSUPPORTED_FORMAT"}


def program(name):
    def register(function):
        PROGRAMS[name] = function
        return function

    return register


def read(*path):
    with open(os.path.join(*path)) as file:
        return json.load(file)


def dump(path, content):
    with open(path, "w") as file:
        json.dump(content, file, default=lambda each: each.tolist())


def apply(matrix, points):
    return np.asarray(points, float) @ matrix[:3, :3].T + matrix[:3, 3]


def rigid(turn, position):
    """A matrix of a rotation, which is a matrix or x, y, z, w, and a position."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn if np.ndim(turn) == 2 else rotation(turn)
    matrix[:3, 3] = position
    return matrix


def nearest(points, others):
    """The largest distance from a point to the nearest of the others."""
    points, others = np.asarray(points, float), np.asarray(others, float)
    return np.linalg.norm(points[:, None] - others[None], axis=2).min(1).max()


def farthest(points, others):
    """The same, both ways."""
    return max(nearest(points, others), nearest(others, points))


def outcome(error, limit, unit):
    found = f"{error:.2g} {unit}".strip()
    return {"passed": bool(error <= limit), "error": float(error), "unit": unit, "result": f"{found}, at most {limit}"}


class Truth:
    def __init__(self, root):
        folder = os.path.join(root, "truth")
        known = read(folder, "truth.json")
        self.points, self.uv, self.volume = np.array(known["points"]), np.array(known["uv"]), known["volume"]
        self.triangles = np.array(known["triangles"], np.int32)
        self.colors = np.array(known["colors"], np.uint8)
        self.face_colors = np.round(self.colors[self.triangles].mean(1)).astype(np.uint8)
        self.linear = light(self.colors)
        self.texture = os.path.join(folder, "texture.png")
        camera = known["camera"]
        self.width, self.height = camera["width"], camera["height"]
        self.fx, self.fy, self.cx, self.cy = (camera[key] for key in ("fx", "fy", "cx", "cy"))
        self.K = np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])
        shape = (self.height, self.width)
        self.depth = np.fromfile(os.path.join(folder, "depth.f32"), np.float32).reshape(shape)
        self.mask = np.fromfile(os.path.join(folder, "mask.u8"), np.uint8).reshape(shape)
        self.mm = np.round(self.depth * 1000).astype(np.uint16)
        self.quaternion, self.translation = np.array(known["pose"]["rotation"]), np.array(known["pose"]["translation"])
        # OpenCV camera from body, and the body's points where the camera sees them.
        self.matrix = rigid(self.quaternion, self.translation)
        self.placed = apply(self.matrix, self.points)
        self.folder = os.path.join(root, "ours")

    def ours(self, *path):
        """The path of a file that we wrote (`ours.mjs`)."""
        return os.path.join(self.folder, *path)

    def read(self, *path):
        return read(self.ours(*path))


class Scene:
    """What the files of our scene should say: one body, and the camera."""

    def __init__(self, t):
        self.body = t.read("found", "scene.json")
        camera = self.body["camera"]
        self.world_from_body = rigid(self.body["rotation"], self.body["position"])
        self.center = apply(self.world_from_body, self.body["centerOfMass"])
        self.mass, self.moments = self.body["mass"], np.sort(self.body["principalMoments"])
        self.points = apply(rigid(camera["rotation"], camera["position"]), t.placed)


class Cells:
    def __init__(self, name, version, root):
        self.named, self.rows = {"program": name, "version": version}, []
        self.version = version
        self.folder = os.path.join(root, "files", f"{name}-{version}".replace(" ", "-"))

    def write(self, kind, variant, file, expect, action, /, *args, **options):
        """A file that `action(path, …)` writes. What a program cannot write is a row of its own, and no cell."""
        folder = os.path.join(self.folder, re.sub(r"\W+", "-", f"{kind} {variant}"))
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, file)
        row = self.named | {"action": "write", "kind": kind, "variant": variant, "file": path}
        try:
            action(path, *args, **options)
            row["expect"] = expect
        except Exception as error:
            row["notWritten"] = f"{type(error).__name__}: {error}"[:300]
        self.rows.append(row)

    def against(self, variant, content, drawn, limit):
        """A mask of another shape as JSON, against what its program draws: differing pixels at most."""

        def write(path):
            dump(path, content)
            np.save(os.path.join(os.path.dirname(path), "expected.npy"), drawn.astype(np.uint8))

        self.write("mask", variant, "mask.json", {"against": "expected.npy", "limitPixels": limit}, write)

    def measure(self, kind, variant, difference, limit=LIMIT, unit=""):
        """How far what a program loaded is from the truth: a number, or several, in the unit of the limit."""
        row = self.named | {"action": "load", "kind": kind, "variant": variant}
        self.rows.append(row | outcome(np.max(np.abs(np.asarray(difference, float))), limit, unit))

    def points(self, kind, variant, found, wanted, limit=LIMIT, distance=farthest):
        """How far points that a program loaded are from those of the truth."""
        self.measure(kind, variant, distance(found, wanted), limit, "m")

    def place(self, question, what, found, expected, limit=1e-6):
        """What a program does in a place where programs differ: a number, which is to be the expected one."""
        self.measure(question, what, found - expected, limit)
        self.rows[-1] |= {"action": "place", "result": f"{round(float(found), 3) + 0:g}"}

    def meshes(self, t, load):
        """Our files of meshes by `load(path)`, which returns the vertices in the world of the file."""
        wanted = dict.fromkeys(("node", "baked", "textured", "scene-camera"), apply(FLIP, t.placed))
        for name, points in (wanted | {"node-opencv": t.placed}).items():
            self.points("GLB", f"{name}.glb", load(t.ours(f"{name}.glb")), points)
        # With a support, the world is the scene's with y up; z up in the files for simulators.
        upright = Scene(t).points[:, [0, 2, 1]] * [1, 1, -1]
        self.points("GLB", "scene.glb: the body above y = 0", upright, load(t.ours("scene.glb")), distance=nearest)
        self.points("PLY", "exportPly", load(t.ours("placed.ply")), t.placed)

    def run(self, t):
        """All of a program. Where it fails, its other cells are missing, and one says why."""
        try:
            PROGRAMS[self.named["program"]](self, t)
        except Exception as error:
            why = {"passed": False, "result": f"{type(error).__name__}: {error}"[:300]}
            self.rows.append(self.named | {"action": "load", "kind": "program", "variant": "all of it"} | why)
