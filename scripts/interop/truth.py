"""The known object: an asymmetric printed body of 17 x 9 x 5 cm, the camera that sees it, its depth map and its mask."""

import json
import os
import struct

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


def colours(points):
    """The print, sRGB: red grows along x, green along y."""
    share = (np.asarray(points) - CORNER)[:, :2] / SIZE[:2]
    return np.c_[40 + 170 * share, np.full(len(share), 160.0)]


def light(srgb):
    srgb = np.asarray(srgb) / 255
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def body():
    """Triangles that were halved twice along each side, so that colours of vertices show the print."""
    points = [*(CORNER + OUTLINE * [1, 1, 0]), *(CORNER + OUTLINE)]
    triangles, ring = [], len(OUTLINE)
    for i in range(ring):
        j = (i + 1) % ring
        triangles += [(i, j, ring + j), (i, ring + j, ring + i)]
        if i > 0 and j > 0:
            triangles += [(0, j, i), (ring, ring + i, ring + j)]
    for _ in range(2):
        middles = {}

        def middle(a, b):
            key = min(a, b), max(a, b)
            if key not in middles:
                middles[key] = len(points)
                points.append((points[a] + points[b]) / 2)
            return middles[key]

        halves = [((a, b, c), middle(a, b), middle(b, c), middle(c, a)) for a, b, c in triangles]
        triangles = [each for (a, b, c), ab, bc, ca in halves for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.array(points), np.array(triangles)


def picture(points, triangles):
    """Depth and mask: rays through the centres of pixels meet the body, or a slanted wall; a hole has no reading."""
    width, height = CAMERA["width"], CAMERA["height"]
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.stack([(u - CAMERA["cx"]) / CAMERA["fx"], (v - CAMERA["cy"]) / CAMERA["fy"], np.ones(u.shape)], 2)
    depth = 0.9 + 0.0005 * u
    wall = depth.copy()
    for a, b, c in points[triangles]:
        p, q, side = b - a, c - a, np.cross(rays, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            area = side @ p
            other = np.cross(-a, p)
            s, t, z = side @ -a / area, rays @ other / area, q @ other / area
        depth = np.where((s >= 0) & (t >= 0) & (s + t <= 1) & (z < depth), z, depth)
    mask = depth < wall
    depth[5:12, 10:20] = 0
    return depth.astype(np.float32), mask.astype(np.uint8)


def glb(points, triangles, print_, texture=b""):
    """The body as a GLB, with light as colours of vertices, or with a texture."""
    parts = [points.astype(np.float32).tobytes(), triangles.astype(np.uint32).tobytes(), print_.astype(np.float32).tobytes(), texture]
    parts = [part + b"\0" * (-len(part) % 4) for part in parts]
    starts, sizes = np.cumsum([0, *map(len, parts)]).tolist(), list(map(len, parts))
    p = points.astype(np.float32)
    bounds = {"min": p.min(0).tolist(), "max": p.max(0).tolist()}
    name, kind = ("TEXCOORD_0", "VEC2") if texture else ("COLOR_0", "VEC3")
    material = {"metallicFactor": 0} | ({"baseColorTexture": {"index": 0}} if texture else {})
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "body"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, name: 2}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": material}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", **bounds},
            {"bufferView": 1, "componentType": 5125, "count": triangles.size, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": len(points), "type": kind},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": starts[i], "byteLength": sizes[i]} for i in range(4 if texture else 3)],
        "buffers": [{"byteLength": starts[-1]}],
    }
    if texture:
        document |= {"textures": [{"source": 0}], "images": [{"bufferView": 3, "mimeType": "image/png"}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", starts[-1], 0x004E4942) + b"".join(parts)
    return struct.pack("<3I", 0x46546C67, 2, 12 + len(chunks)) + chunks


def write(folder):
    """What the programs read: `truth.json`, a texture, two GLB files, and the bare numbers of depth and mask."""
    from PIL import Image

    from .cells import rotation

    os.makedirs(folder, exist_ok=True)
    points, triangles = body()
    colors = np.round(colours(points))
    uv = MARGIN + (1 - 2 * MARGIN) * (points - CORNER)[:, :2] / SIZE[:2]
    a, b, c = points[triangles].transpose(1, 0, 2)
    known = {"points": points, "triangles": triangles, "colors": colors, "uv": uv, "corner": CORNER, "size": SIZE}
    known = {name: each.tolist() for name, each in known.items()}
    known |= {"volume": float((a * np.cross(b, c)).sum() / 6), "camera": CAMERA}
    known["pose"] = {"scale": 1, "rotation": QUATERNION.tolist(), "translation": TRANSLATION.tolist()}
    with open(os.path.join(folder, "truth.json"), "w") as file:
        json.dump(known, file)
    depth, mask = picture(points @ rotation(QUATERNION).T + TRANSLATION, triangles)
    depth.tofile(os.path.join(folder, "depth.f32"))
    mask.tofile(os.path.join(folder, "mask.u8"))
    u, v = np.meshgrid((np.arange(68) + 0.5) / 68, 1 - (np.arange(36) + 0.5) / 36)
    share = (np.stack([u, v], 2) - MARGIN) / (1 - 2 * MARGIN)
    places = np.concatenate([CORNER[:2] + SIZE[:2] * share, np.zeros((36, 68, 1))], 2).reshape(-1, 3)
    Image.fromarray(np.round(colours(places)).astype(np.uint8).reshape(36, 68, 3)).save(os.path.join(folder, "texture.png"))
    with open(os.path.join(folder, "texture.png"), "rb") as file:
        texture = file.read()
    for name, data in (("vertex", glb(points, triangles, light(colors))), ("texture", glb(points, triangles, uv * [1, -1] + [0, 1], texture))):
        with open(os.path.join(folder, f"{name}.glb"), "wb") as file:
            file.write(data)
