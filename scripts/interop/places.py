"""Deep places, where programs differ and a fast answer is wrong: the questions, and what their answers are computed with."""

import base64
import json

import numpy as np

PIXEL = "the first pixel's centre, pixels"
RAY = "depth in the corner of an image of a wall at 1 m, metres"
EDGE = "share of readings of a depth map at half its size that are of no surface, %"
GREY = "the colour 188 of a vertex in a GLB"
BOX = "longest side of the box of a turned body of 0.17 m, metres"


def mixed(t, small):
    """The share of readings that are farther than a centimetre from all that they come from."""
    blocks = t.depth.reshape(t.height // 2, 2, t.width // 2, 2).transpose(0, 2, 1, 3).reshape(t.height // 2, t.width // 2, 4)
    return 100 * (np.abs(blocks - np.asarray(small)[..., None]).min(-1) > 0.01).mean()


def turned(points):
    """The points, turned by 30° about z, x and y."""
    for a, b in ((0, 1), (1, 2), (2, 0)):
        turn = np.eye(3)
        turn[[a, b], [a, b]] = np.cos(np.pi / 6)
        turn[a, b], turn[b, a] = -np.sin(np.pi / 6), np.sin(np.pi / 6)
        points = points @ turn.T
    return points


def grey(path):
    """The first number of the colours in a GLB."""
    with open(path, "rb") as file:
        data = file.read()
    length = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20 : 20 + length]), data[28 + length :]
    accessor = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    view = gltf["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    uri = gltf["buffers"][view["buffer"]].get("uri")
    binary = binary if uri is None else base64.b64decode(uri.split(",")[1])
    kind = {5121: np.uint8, 5123: np.uint16, 5126: np.float32}[accessor["componentType"]]
    return float(np.frombuffer(binary, kind, 1, start)[0])
