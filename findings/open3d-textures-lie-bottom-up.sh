#!/usr/bin/env bash
# Open3D: a picture that read_image returns is upside down as a texture.
#
# One would expect: mesh.textures = [open3d.io.read_image("print.png")], with triangle_uvs as in an OBJ file (v counts from the
# bottom of the picture), is the mesh that an OBJ file with the same numbers and the same print.png describes.
#
# What happens: textures of a TriangleMesh are stored from the bottom row up. The reader of OBJ turns the picture round, the
# writer turns it back; read_image does not. Written as OBJ, the texture made of read_image is upside down in the file beside it. Nothing in the documentation of `textures` says so.
#
# Versions: open3d 0.20.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: scripts attach the photo of a scan or a generated texture in this way. Shape and size are right, the print
# stands on its head, so a comparison with the photo prefers the object upside down.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet open3d==0.20.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import open3d as o3d

picture = np.zeros((4, 4, 3), np.uint8)
picture[0] = (255, 0, 0)
o3d.io.write_image("print.png", o3d.geometry.Image(picture))
top = lambda path: np.asarray(o3d.io.read_image(path))[0, 0].tolist()
vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(vertices), o3d.utility.Vector3iVector([[0, 1, 2], [0, 2, 3]]))
mesh.triangle_uvs = o3d.utility.Vector2dVector([[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]])
mesh.triangle_material_ids = o3d.utility.IntVector([0, 0])
mesh.textures = [o3d.io.read_image("print.png")]
assert o3d.io.write_triangle_mesh("made.obj", mesh)
with open("print.mtl", "w") as file:
    file.write("newmtl print\nKd 1 1 1\nmap_Kd print.png\n")
with open("read.obj", "w") as file:
    file.write("mtllib print.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl print\n")
    file.write("f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
read = np.asarray(o3d.io.read_triangle_mesh("read.obj").textures[-1])
print(f"open3d {o3d.__version__}: the first row of print.png is {top('print.png')}")
print(f"that of the texture beside made.obj is {top('made_0.png')}")
print(f"an OBJ beside print.png is read with {read[0, 0].tolist()} in the first row and {read[-1, 0].tolist()} in the last")
assert top("print.png") == [255, 0, 0] and top("made_0.png") == [0, 0, 0] == read[0, 0].tolist(), "the behaviour has changed"
PYTHON
