#!/usr/bin/env bash
# Open3D: a mesh below a mirrored glTF node comes out inside out.
#
# One would expect: read_triangle_mesh of a GLB whose node has the scale (-1, 1, 1) gives the mirrored body with its outside out.
# glTF says so: where the determinant of a node's transform is negative, the winding of its triangles is reversed.
#
# What happens: the vertices are mirrored, the triangles are left as they are. All face inwards: the signed volume is negative,
# normals that are computed from them point inwards, and RaycastingScene's signed distances are of a body turned inside out.
#
# Versions: open3d 0.20.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: symmetric furniture, car parts and shoes are stored once and placed a second time by a mirrored node. Whoever
# culls back faces, samples the visible side, uses point-to-plane ICP with normals or renders depth of the mesh sees its far side.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet open3d==0.20.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import json
import struct

import numpy as np
import open3d as o3d

points = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], np.float32) * np.float32([0.1, 0.2, 0.3])
quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
faces = np.array([each for a, b, c, d in quads for each in ((a, b, c), (a, c, d))], np.uint32)


def write(path, node):
    data = points.tobytes() + faces.tobytes()
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 144}]
    bounds = {"min": points.min(0).tolist(), "max": points.max(0).tolist()}
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", **bounds}]
    accessors.append({"bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR"})
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **node}]}
    document |= {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "accessors": accessors}
    text = json.dumps(document | {"buffers": [{"byteLength": len(data)}], "bufferViews": views}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", len(data), 0x004E4942) + data
    with open(path, "wb") as file:
        file.write(struct.pack("<3I", 0x46546C67, 2, 12 + len(chunks)) + chunks)


volumes = []
for name, node in (("plain", {}), ("mirrored", {"scale": [-1, 1, 1]})):
    write("box.glb", node)
    mesh = o3d.io.read_triangle_mesh("box.glb")
    vertices = np.asarray(mesh.vertices)
    a, b, c = (vertices[np.asarray(mesh.triangles)[:, k]] for k in range(3))
    volumes.append((a * np.cross(b, c)).sum() / 6)
    print(f"open3d {o3d.__version__}, {name} node: x from {vertices[:, 0].min():.1f} to {vertices[:, 0].max():.1f}, signed volume {volumes[-1]:.4f}")
assert abs(volumes[0] - 0.006) < 1e-6 and abs(volumes[1] + 0.006) < 1e-6, "the behaviour has changed"
PYTHON
