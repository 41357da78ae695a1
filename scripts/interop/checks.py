"""Whether our readers gave back the known object, to stated limits, or the error that is stated.

Beside the truth, a cell may expect: `refused` (the code of the error) and what it `says`; what a warning `warns` of; the `axes` and the
`unit` of a mesh (units in a metre), its `colors` (whose: vertex, face, texture), `colorLimit` (levels) and `colorFactor` (of light); `limitM`
(metres); of depth, `only` the mask and a `share` of pixels; `limitPixels` of a mask, or what it is `against`; numbers of a `camera`.
"""

import os
import re

import numpy as np

from .cells import FLIP, LIMIT, Truth, apply, dump, farthest, outcome, read
from .truth import colours, light

# To the body's axes from those of the file.
AXES = {"same": np.eye(3), "-x": np.diag([-1.0, 1, 1])}
AXES["y-up"] = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
AXES["y and z swapped"] = np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]])
LEVELS = {"vertex": 2, "texture": 3, "face": 8}


def said(found, expect):
    texts = "; ".join(found["said"])
    fits = re.search(expect["warns"], texts, re.I) if "warns" in expect else texts == ""
    assert fits, f"warns: {texts}"


def mesh(t, found, expect):
    said(found, expect)
    axes = AXES[expect.get("axes", "same")]
    in_body = lambda numbers: np.reshape(numbers, (-1, 3)) @ axes.T / expect.get("unit", 1)
    points, triangles = in_body(found["positions"]), np.reshape(found["indices"], (-1, 3))
    limit = expect.get("limitM", 2e-7)
    a, b, c = points[triangles].transpose(1, 0, 2)
    volume = np.linalg.det(axes) * (a * np.cross(b, c)).sum() / 6 / t.volume
    assert abs(volume - 1) < 1e-4 + 100 * limit, f"volume {volume:.4f} of the body's"
    if "colors" in expect:
        assert found["colors"], "no colours"
        wanted = colours(in_body(found["places"]))
        if "colorFactor" in expect:
            wanted = 255 * (1.055 * (expect["colorFactor"] * light(wanted)) ** (1 / 2.4) - 0.055)
        levels = np.abs(wanted - np.reshape(found["colors"], (-1, 3))).mean()
        most = expect.get("colorLimit", LEVELS[expect["colors"]])
        assert levels <= most, f"colours differ by {levels:.1f} levels, more than {most}"
    return farthest(points, t.points), limit, "m"


def depth(t, found, expect):
    assert [found["width"], found["height"]] == [t.width, t.height], f"size {found['width']} x {found['height']}"
    differences = np.abs(np.reshape(found["data"], t.depth.shape) - t.depth)
    differences = np.sort(differences[t.mask > 0] if "only" in expect else differences.ravel())
    return differences[int(np.ceil(expect.get("share", 1) * len(differences))) - 1], expect.get("limitM", 1e-7), "m"


def mask(t, found, expect):
    assert [found["width"], found["height"]] == [t.width, t.height], f"size {found['width']} x {found['height']}"
    wanted = np.load(expect["against"]) if "against" in expect else t.mask
    return (np.reshape(found["data"], t.mask.shape) != wanted).sum(), expect.get("limitPixels", 0), "pixels"


def camera(t, found, expect):
    said(found, expect)
    wanted = {"fx": t.fx, "fy": t.fy, "cx": t.cx, "cy": t.cy} | expect.get("camera", {})
    return max(abs(found[key] - each) for key, each in wanted.items()), 1e-3, "pixels"


def pose(t, found, expect):
    return np.abs(apply(np.reshape(found["matrix"], (4, 4)).T, t.points) - t.placed).max(), 1e-6, "m"


def glb(t, found, expect):
    """What a program of npm shows of our file: points in the frame of its camera."""
    wanted = t.placed if expect["frame"] == "opencv" else apply(FLIP, t.placed)
    return farthest(np.reshape(found["positions"], (-1, 3)), wanted), LIMIT, "m"


def cell(t, row):
    expect = row.pop("expect")
    found = read(row.pop("read"))
    if "code" in found:
        stated = found["code"] == expect.get("refused") and re.search(expect.get("says", ""), found["message"], re.I)
        return row | {"passed": bool(stated), "result": f"refused: {found['message']}"}
    if "refused" in expect:
        return row | {"passed": False, "result": f"read, instead of {expect['refused']}"}
    if "against" in expect:
        expect["against"] = os.path.join(os.path.dirname(row["file"]), expect["against"])
    try:
        return row | outcome(*globals()[row["kind"].lower()](t, found, expect))
    except AssertionError as error:
        return row | {"passed": False, "result": str(error)}


def check(root):
    path = os.path.join(root, "rows", "read.json")
    t = Truth(root)
    dump(path, [cell(t, row) for row in read(path)])
