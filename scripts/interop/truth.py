"""The known object: an asymmetric printed body of 17 x 9 x 5 cm, the camera that sees it, its depth map and its mask."""

import json
import os

import numpy as np

CORNER, SIZE = np.array([-0.02, 0.01, 0.03]), np.array([0.17, 0.09, 0.05])
# Its outline from above and the heights of its top, in centimetres: no two directions look alike.
OUTLINE = np.array([[0, 0, 5], [17, 0, 3], [17, 4, 5], [8, 9, 4], [0, 9, 5]]) / 100
# Of the texture, on each side: its edges are no part of the print, because a repeated texture blends them.
MARGIN = 0.1
# OpenCV camera from body, metres; x, y, z, w.
QUATERNION = np.array([0.9, 0.25, 0.2, np.sqrt(1 - 0.9**2 - 0.25**2 - 0.2**2)])
TRANSLATION = np.array([-0.1, 0.01, 0.35])
CAMERA = {"fx": 150, "fy": 152, "cx": 78.5, "cy": 60.25, "width": 160, "height": 120}


def rotation(xyzw):
    x, y, z, w = np.asarray(xyzw, float) / np.linalg.norm(xyzw)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def colours(points):
    """The print, sRGB: red grows along x, green along y."""
    share = (np.asarray(points)[:, :2] - CORNER[:2]) / SIZE[:2]
    return np.c_[40 + 170 * share, np.full(len(share), 160.0)]


def light(srgb):
    srgb = np.asarray(srgb) / 255
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def body():
    """Triangles that were halved twice along each side, so that colours of vertices show the print."""
    from trimesh.remesh import subdivide

    points = [*(CORNER + OUTLINE * [1, 1, 0]), *(CORNER + OUTLINE)]
    triangles, ring = [], len(OUTLINE)
    for i in range(ring):
        j = (i + 1) % ring
        triangles += [(i, j, ring + j), (i, ring + j, ring + i)]
        if i > 0 and j > 0:
            triangles += [(0, j, i), (ring, ring + i, ring + j)]
    return subdivide(*subdivide(np.array(points), np.array(triangles)))


def picture(points, triangles):
    """Depth and mask: rays through the centres of pixels meet the body, or a slanted wall; a hole has no reading."""
    v, u = np.mgrid[: CAMERA["height"], : CAMERA["width"]]
    rays = np.stack([(u - CAMERA["cx"]) / CAMERA["fx"], (v - CAMERA["cy"]) / CAMERA["fy"], np.ones(u.shape)], 2)
    wall = depth = 0.9 + 0.0005 * u
    for a, b, c in points[triangles]:
        p, q = b - a, c - a
        side, other = np.cross(rays, q), np.cross(-a, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            area = side @ p
            s, t, z = side @ -a / area, rays @ other / area, q @ other / area
        depth = np.where((s >= 0) & (t >= 0) & (s + t <= 1) & (z < depth), z, depth)
    mask = depth < wall
    depth[5:12, 10:20] = 0
    return depth.astype(np.float32), mask.astype(np.uint8)


def write(root):
    """What the programs read: `truth.json`, a texture, two GLB files, and the bare numbers of depth and mask."""
    import trimesh
    from PIL import Image

    folder = os.path.join(root, "truth")
    os.makedirs(folder, exist_ok=True)
    points, triangles = body()
    colors = np.round(colours(points))
    uv = MARGIN + (1 - 2 * MARGIN) * (points - CORNER)[:, :2] / SIZE[:2]
    volume = trimesh.Trimesh(points, triangles, process=False).volume
    known = {"points": points, "triangles": triangles, "colors": colors, "lights": light(colors), "uv": uv, "corner": CORNER}
    known = {name: each.tolist() for name, each in known.items()} | {"volume": float(volume), "camera": CAMERA}
    known["pose"] = {"scale": 1, "rotation": QUATERNION.tolist(), "translation": TRANSLATION.tolist()}
    with open(os.path.join(folder, "truth.json"), "w") as file:
        json.dump(known, file)

    depth, mask = picture(points @ rotation(QUATERNION).T + TRANSLATION, triangles)
    depth.tofile(os.path.join(folder, "depth.f32"))
    mask.tofile(os.path.join(folder, "mask.u8"))

    row, column = np.mgrid[:36, :68] + 0.5
    share = (np.c_[column.ravel() / 68, 1 - row.ravel() / 36] - MARGIN) / (1 - 2 * MARGIN)
    print_ = np.round(colours(CORNER[:2] + SIZE[:2] * share)).astype(np.uint8)
    image = Image.fromarray(print_.reshape(36, 68, 3))
    image.save(os.path.join(folder, "texture.png"))

    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0)
    textured = trimesh.Trimesh(points, triangles, process=False)
    textured.visual = trimesh.visual.TextureVisuals(uv, material)
    textured.export(os.path.join(folder, "texture.glb"))

    # trimesh writes colours as bytes: as an attribute of its own they are floats of light.
    lights = light(colors).astype(np.float32)
    lit = trimesh.Trimesh(points, triangles, process=False, vertex_attributes={"_COLOR_0": lights})

    def rename(tree):
        attributes = tree["meshes"][0]["primitives"][0]["attributes"]
        attributes["COLOR_0"] = attributes.pop("_COLOR_0")

    lit.export(os.path.join(folder, "vertex.glb"), tree_postprocessor=rename)
