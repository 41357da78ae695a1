"""The known object: an asymmetric printed body of 17 x 9 x 5 cm, the camera that sees it, its depth map and its mask."""

import json
import os
from types import SimpleNamespace

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


class Truth(SimpleNamespace):
    """The object as arrays, by the names that `writes.json` has, and the files that show it."""

    def __init__(self, root):
        self.folder = os.path.join(root, "truth")
        self.texture = os.path.join(self.folder, "texture.png")
        self.root = root
        with np.load(os.path.join(self.folder, "truth.npz")) as known:
            super().__init__(**{name: each if each.ndim else each.item() for name, each in known.items()})

    def ours(self, *path):
        """The path of a file that we wrote (`ours.mjs`)."""
        return os.path.join(self.root, "ours", *path)

    def read(self, *path):
        with open(self.ours(*path)) as file:
            return json.load(file)


def apply(matrix, points):
    return np.asarray(points, float) @ matrix[:3, :3].T + matrix[:3, 3]


def rigid(turn, position):
    """A matrix of a rotation, which is a matrix or x, y, z, w, and a position."""
    from scipy.spatial.transform import Rotation

    matrix = np.eye(4)
    matrix[:3, :3] = turn if np.ndim(turn) == 2 else Rotation.from_quat(turn).as_matrix()
    matrix[:3, 3] = position
    return matrix


def colours(points):
    """The print, sRGB: red grows along x, green along y."""
    share = (np.asarray(points)[:, :2] - CORNER[:2]) / SIZE[:2]
    return np.c_[40 + 170 * share, np.full(len(share), 160.0)]


def light(srgb):
    srgb = np.asarray(srgb) / 255
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def volume(points, triangles):
    a, b, c = points[triangles].transpose(1, 0, 2)
    return (a * np.cross(b, c)).sum() / 6


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
    return rays, depth.astype(np.float32), mask.astype(np.uint8)


def known():
    """Everything about the object, as arrays."""
    import cv2
    from scipy.spatial.transform import Rotation

    points, triangles = body()
    colors = np.round(colours(points)).astype(np.uint8)
    face_colors = np.round(colors[triangles].mean(1)).astype(np.uint8)
    rgba, face_rgba = (np.c_[each, np.full(len(each), 255, np.uint8)] for each in (colors, face_colors))
    matrix = rigid(QUATERNION, TRANSLATION)
    placed = apply(matrix, points)

    rays, depth, mask = picture(placed, triangles)
    level = mask * np.uint8(255)
    fx, fy, cx, cy = (CAMERA[name] for name in ("fx", "fy", "cx", "cy"))
    rows, columns = np.nonzero(mask)
    return CAMERA | {
        "points": points,
        "triangles": triangles.astype(np.int32),
        "volume": volume(points, triangles),
        "uv": MARGIN + (1 - 2 * MARGIN) * (points - CORNER)[:, :2] / SIZE[:2],
        "colors": colors,
        "rgba": rgba,
        "face_rgba": face_rgba,
        "lights": light(colors),
        # By 30° about z, x and y.
        "turned": Rotation.from_euler("zxy", [30, 30, 30], degrees=True).apply(points),
        # OpenCV camera from body, and the body's points where the camera sees them.
        "quaternion": QUATERNION,
        "translation": TRANSLATION,
        "matrix": matrix,
        "placed": placed,
        "K": np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]]),
        "depth": depth,
        "mm": np.round(depth * 1000).astype(np.uint16),
        # OpenCV takes three channels for blue, green and red, and so turns x, y, z round.
        "zyx": (rays * depth[..., None])[..., ::-1].astype(np.float32),
        "mask": mask,
        # The runs of its columns, as COCO counts them.
        "runs": np.diff(np.r_[0, np.flatnonzero(np.diff(mask.ravel(order="F"), prepend=0)), mask.size]),
        # The middles of its outermost pixels.
        "outline": cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0][0][:, 0],
        # Its first and its last pixels, what is between them, and a box around them.
        "mask_corners": np.array([[columns.min(), rows.min()], [columns.max(), rows.max()]], float),
        "mask_part": mask[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1],
        "box": np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]),
        "cut_out": np.dstack([level // 2 + 90, level // 3 + 40, level // 4 + 70, level]),
    }


def write(root):
    """What the programs read: the arrays, some of them as JSON, a texture, and two GLB files."""
    import trimesh
    from PIL import Image

    folder = os.path.join(root, "truth")
    os.makedirs(folder, exist_ok=True)
    arrays = known()
    np.savez(os.path.join(folder, "truth.npz"), **arrays)
    plain = {name: arrays[name].tolist() for name in ("points", "triangles", "lights", "mask")}
    pose = {"scale": 1, "rotation": QUATERNION.tolist(), "translation": TRANSLATION.tolist()}
    # The plane below the body, in the frame of the camera.
    normal = arrays["matrix"][:3, 2]
    support = {"normal": normal.tolist(), "d": -normal @ apply(arrays["matrix"], [0, 0, CORNER[2]])}
    with open(os.path.join(folder, "truth.json"), "w") as file:
        json.dump(plain | {"pose": pose, "camera": CAMERA, "support": support}, file)

    row, column = np.mgrid[:36, :68] + 0.5
    share = (np.c_[column.ravel() / 68, 1 - row.ravel() / 36] - MARGIN) / (1 - 2 * MARGIN)
    print_ = np.round(colours(CORNER[:2] + SIZE[:2] * share)).astype(np.uint8)
    image = Image.fromarray(print_.reshape(36, 68, 3))
    image.save(os.path.join(folder, "texture.png"))

    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0)
    textured = trimesh.Trimesh(arrays["points"], arrays["triangles"], process=False)
    textured.visual = trimesh.visual.TextureVisuals(arrays["uv"], material)
    textured.export(os.path.join(folder, "texture.glb"))

    # trimesh writes colours as bytes: as an attribute of its own they are floats of light.
    attributes = {"_COLOR_0": arrays["lights"].astype(np.float32)}
    lit = trimesh.Trimesh(arrays["points"], arrays["triangles"], process=False, vertex_attributes=attributes)

    def rename(tree):
        attributes = tree["meshes"][0]["primitives"][0]["attributes"]
        attributes["COLOR_0"] = attributes.pop("_COLOR_0")

    lit.export(os.path.join(folder, "vertex.glb"), tree_postprocessor=rename)
