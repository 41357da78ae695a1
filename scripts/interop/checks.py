"""Whether our readers gave back the known object, and programs found it in our files, to stated limits.

A cell expects a `wanted` number, or what a name stands for, to a `limit`: points in metres, others in a `unit`. It may be `relative`,
points `among` others, or a `share` of the pixels, `only` in the mask. A mesh may have `axes` (rows of a matrix that leads to the body's), a
unit (units in a `metre`), and `colors` (whose: vertex, face, texture) to a `colorLimit` (levels), with a `colorFactor` (of light). A reader
`warns`, or has `refused` the file with this code, and `says` why.
"""

import json
import re

import numpy as np
from scipy.spatial.distance import directed_hausdorff

from .cells import FLIP, dump
from .truth import Truth, apply, colours, light, rigid, volume


def facts(t):
    """What is to be found: points, and numbers."""
    scene, cuboid = t.read("found", "scene.json"), t.read("cuboid.json")
    world_from_body = rigid(scene["rotation"], scene["position"])
    surface = apply(rigid(scene["camera"]["rotation"], scene["camera"]["position"]), t.placed)
    points = {
        "body": t.points,
        "placed": t.placed,
        "placed, OpenGL": apply(FLIP, t.placed),
        "surface": surface,
        # With a support, the world of a GLB is the scene's with y up; z up in the files for simulators.
        "surface, y up": surface[:, [0, 2, 1]] * [1, 1, -1],
        "corners": np.reshape(cuboid["corners"], (-1, 3)),
    }
    numbers = {
        "depth": t.depth,
        "mask": t.mask,
        "lens": [t.fx, t.fy, t.cx, t.cy],
        "lens, fy = fx": [t.fx, t.fx, t.cx, t.cy],
        "focal length": t.fx,
        "principal point": [t.cx, t.cy],
        "corner ray": np.linalg.norm(np.linalg.inv(t.K) @ [0, 0, 1]),
        "rotation": t.matrix[:3, :3],
        "matrix": world_from_body,
        "quaternion": scene["rotation"],
        "mass": scene["mass"],
        "centre of mass": apply(world_from_body, scene["centerOfMass"]),
        "centre of mass in the body": scene["centerOfMass"],
        "moments": np.sort(scene["principalMoments"]),
        "parts": scene["parts"],
    }
    return points, numbers


def mesh(t, found, expect):
    """The points of a mesh in the axes of the body, once its volume and its colours are right."""
    axes = np.array(expect.get("axes", np.eye(3)))
    in_body = lambda numbers: np.reshape(numbers, (-1, 3)) @ axes.T / expect.get("metre", 1)
    points = in_body(found["positions"])
    share = np.linalg.det(axes) * volume(points, np.reshape(found["indices"], (-1, 3))) / t.volume
    assert abs(share - 1) < 1e-4 + 100 * expect["limit"], f"volume {share:.4f} of the body's"

    if "colors" in expect:
        assert found["colors"], "no colours"
        wanted = colours(in_body(found["places"]))
        if "colorFactor" in expect:
            wanted = 255 * (1.055 * (expect["colorFactor"] * light(wanted)) ** (1 / 2.4) - 0.055)
        levels = np.abs(wanted - np.reshape(found["colors"], (-1, 3))).mean()
        assert levels <= expect["colorLimit"], f"colours differ by {levels:.1f} levels, more than {expect['colorLimit']}"
    return points


def mixed(t, small):
    """The percentage of readings that are farther than a centimetre from all that they come from, at half the size."""
    rows, columns = t.height // 2, t.width // 2
    blocks = t.depth.reshape(rows, 2, columns, 2).transpose(0, 2, 1, 3).reshape(rows, columns, 4)
    return 100 * (np.abs(blocks - np.asarray(small)[..., None]).min(-1) > 0.01).mean()


def difference(t, known, found, expect):
    points, numbers = known
    wanted = expect["wanted"]
    if wanted in points:
        found = np.reshape(found, (-1, 3))
        both = [directed_hausdorff(points[wanted], found)[0], directed_hausdorff(found, points[wanted])[0]]
        return both[0] if expect.get("among") else max(both)

    wanted = np.asarray(numbers.get(wanted, wanted), float)
    found = np.reshape(np.asarray(found, float), wanted.shape if wanted.ndim else np.shape(found))
    differences = np.abs(found - wanted) / (wanted if expect.get("relative") else 1)
    if expect.get("unit") == "pixels" and wanted.ndim == 2:
        return np.count_nonzero(differences)
    differences = np.sort(differences[t.mask > 0] if "only" in expect else differences.ravel())
    return differences[int(np.ceil(expect.get("share", 1) * len(differences))) - 1]


def cell(t, known, row):
    """What came of a row: whether it is as stated, and the difference."""
    found = row.pop("found")
    expect = row.pop("expect")
    if isinstance(found, dict) and "code" in found:
        stated = found["code"] == expect.get("refused") and re.search(expect.get("says", ""), found["message"], re.I)
        return row | {"passed": bool(stated), "result": f"refused: {found['message']}"}
    if "refused" in expect:
        return row | {"passed": False, "result": f"read, instead of {expect['refused']}"}

    try:
        if row["action"] == "write":
            texts = "; ".join(found["said"])
            assert re.search(expect["warns"], texts, re.I) if "warns" in expect else texts == "", f"warns: {texts}"
            found = mesh(t, found, expect) if row["kind"] == "mesh" else found["data"]
        if row["kind"] == "edge":
            found = mixed(t, found)
        error = difference(t, known, found, expect)
    except (AssertionError, ValueError) as wrong:
        return row | {"passed": False, "result": str(wrong)}

    limit = expect.get("limit", 1e-6)
    unit = "m" if expect["wanted"] in known[0] else expect.get("unit", "")
    result = f"{round(float(found), 3) + 0:g}" if row["action"] == "place" else f"{error:.2g} {unit}".strip() + f", at most {limit}"
    return row | {"passed": bool(error <= limit), "error": float(error), "unit": unit, "result": result}


def check(root, path):
    t = Truth(root)
    known = facts(t)
    with open(path) as file:
        rows = json.load(file)
    dump(path, [row if "passed" in row else cell(t, known, row) for row in rows])
