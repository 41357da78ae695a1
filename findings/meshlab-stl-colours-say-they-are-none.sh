#!/usr/bin/env bash
# MeshLab: the colours of facets in its STL files are marked as "no colour of its own".
#
# One would expect: a binary STL with a colour for each facet, saved with MeshLab's default (the header of Materialise Magics,
# "COLOR=...MATERIAL=..."), follows Magics: five bits each for red, green and blue, and bit 15 clear where the facet has its own
# colour, set where it has that of the header.
#
# What happens: MeshLab writes the colours and sets bit 15 in every facet. By the rule of the header, the whole object has the grey
# of the header, 127 127 127, and the colours do not count. MeshLab itself reads them back, so a round trip hides it. Without the
# header (colormode=False) bit 15 is set as well, but there, by the rule of VisCAM, it means that the colour counts.
#
# Versions: pymeshlab 2025.7.post1, numpy 2.4.6, Python 3.11.
#
# Why it matters: STL is what printers and CAD exchange, and its colours are all that a photo of the object can be compared with.
# A reader that keeps to the rule shows one grey, without an error.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pymeshlab==2025.7.post1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import importlib.metadata
import struct

import numpy as np
import pymeshlab

vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
colors = np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [1, 1, 1, 1.0]])
meshes = pymeshlab.MeshSet()
meshes.add_mesh(pymeshlab.Mesh(vertices, faces, f_color_matrix=colors))
meshes.save_current_mesh("mesh.stl", save_face_color=True)
with open("mesh.stl", "rb") as file:
    data = file.read()
attributes = [struct.unpack("<H", data[84 + 50 * i + 48 : 84 + 50 * i + 50])[0] for i in range(4)]
print(f"pymeshlab {importlib.metadata.version('pymeshlab')}: the header begins with {data[:22]}")
for name, attribute in zip(("red", "green", "blue", "white"), attributes):
    bits = [attribute >> shift & 31 for shift in (0, 5, 10)]
    print(f"{name}: bit 15 is {attribute >> 15}, red, green, blue are {bits} of 31")
assert data.startswith(b"COLOR=") and all(attribute >> 15 for attribute in attributes) and len(set(attributes)) == 4, "the behaviour has changed"
again = pymeshlab.MeshSet()
again.load_new_mesh("mesh.stl")
print("MeshLab reads:", again.current_mesh().face_color_matrix()[:, :3].round(1).tolist())
PYTHON
