"""
`python -m kitchen FOLDER`: a scene of three objects on a kitchen table, path-traced by Cycles. Writes the photo, a depth map and
masks with the errors of networks, meshes with those of generators, and the poses that are right.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from . import generator, room, sensor, things

SAMPLES = 48
# By how many pixels the outline of each object is too far out.
GROWN_PX = {"duck": 0.5, "mug": -0.3, "box": -0.4}


def main(folder, samples):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rng = np.random.default_rng(7)
    objects = things.placed()
    room.furnish()
    room.light()
    room.camera()
    folder.mkdir(parents=True, exist_ok=True)

    depth, index = room.measured(folder / "facts.exr")
    millimetres = np.rint(1000 * sensor.depth_seen(depth, rng)).astype(np.uint16)
    Image.fromarray(millimetres).save(folder / "depth.png")
    width, height = room.SIZE
    camera = {"cx": width / 2 - 0.5, "cy": height / 2 - 0.5, "fx": room.FOCAL_PX, "fy": room.FOCAL_PX}
    write_json(folder / "camera.json", {**camera, "width": width, "height": height, "depthScale": 0.001})

    to_camera = room.camera_from_world()
    for name, thing in objects.items():
        own = folder / "objects" / name
        own.mkdir(parents=True, exist_ok=True)
        mask = sensor.mask_seen(index == thing.pass_index, GROWN_PX[name], rng)
        Image.fromarray(255 * mask.astype(np.uint8)).save(own / "mask.png")
        mesh, made, world = generator.generated(thing, name, rng)
        generator.write(mesh, str(own / "mesh.glb"))
        scale, rotation, translation = generator.similarity(made, world @ to_camera[:3, :3].T + to_camera[:3, 3])
        truth = {"scale": scale, "rotation": rotation.tolist(), "translation": translation.tolist()}
        write_json(own / "gt.json", {"available": True, "note": f"rendered: {name}", "symmetry": "none", **truth})
        bpy.data.objects.remove(mesh)

    room.render(folder / "rgb.png", samples)
    Image.open(folder / "rgb.png").convert("RGB").save(folder / "rgb.webp", quality=84, method=6)


def write_json(path, content):
    path.write_text(json.dumps(content, indent=2) + "\n")


main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else SAMPLES)
