#!/usr/bin/env bash
# trimesh: a textured mesh is much darker as GLB than as OBJ.
#
# One would expect: TextureVisuals(uv=uv, image=image), the way to give a mesh a picture, shows this picture in every format.
#
# What happens: it makes a SimpleMaterial whose diffuse colour is a grey of 0.4 by default. The OBJ names the picture as map_Kd,
# which viewers show as it is. The GLB gets baseColorFactor 0.4 beside baseColorTexture, and glTF multiplies the two, as light: a
# white page is shown with sRGB 170 instead of 255. Reading the OBJ of trimesh and saving it as GLB dims it likewise, because the
# 0.4 is in its MTL as Kd. PBRMaterial(baseColorTexture=image) has no factor.
#
# Versions: trimesh 5.2.0, pillow 13.0.0, numpy 2.4.6, Python 3.11.
#
# Why it matters: meshes are coloured, converted and compared with photos in such pipelines. A mesh that is 40 % as bright as its
# own texture fits the shadows of the photo better than its object.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet trimesh==5.2.0 pillow==13.0.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import json
import struct

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial


def factor(mesh):
    data = mesh.export(file_type="glb")
    document = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    material = document["materials"][0]["pbrMetallicRoughness"]
    assert "baseColorTexture" in material
    return material.get("baseColorFactor", [1, 1, 1, 1])[0]


image = Image.new("RGB", (8, 8), "white")
uv = np.array([[0, 0], [1, 0], [0, 1.0]])
body = lambda visual: trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False, visual=visual)
simple, pbr = body(TextureVisuals(uv=uv, image=image)), body(TextureVisuals(uv=uv, material=PBRMaterial(baseColorTexture=image)))
simple.export("page.obj")
found = factor(simple), factor(trimesh.load("page.obj", force="mesh")), factor(pbr)
shown = 255 * (1.055 * found[0] ** (1 / 2.4) - 0.055)
print(f"trimesh {trimesh.__version__}: factor of the texture in the GLB: {found[0]:.3f}, by way of OBJ {found[1]:.3f}, PBRMaterial {found[2]:.3f}")
print(f"white is shown as sRGB {shown:.0f}")
assert abs(found[0] - 0.4) < 0.01 and abs(found[1] - 0.4) < 0.01 and found[2] == 1, "the behaviour has changed"
PYTHON
