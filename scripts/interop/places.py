"""Deep places, where programs differ and a fast answer is wrong: what each does, as a number."""

import base64
import json
import os

import numpy as np

from .cells import program

PIXEL = "the first pixel's centre, pixels"
RAY = "depth in the corner of an image of a wall at 1 m, metres"
EDGE = "share of readings of a depth map at half its size that are of no surface, %"
GREY = "the colour 188 of a vertex in a GLB"
BOX = "longest side of the box of a turned body of 0.17 m, metres"


def wall(t):
    """Directions of length 1 through the centres of pixels."""
    v, u = np.mgrid[: t.height, : t.width]
    rays = np.stack([(u - t.cx) / t.fx, (v - t.cy) / t.fy, np.ones(u.shape)], -1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def mixed(t, small):
    """The share of readings that are farther than a centimetre from all that they come from."""
    blocks = t.depth.reshape(t.height // 2, 2, t.width // 2, 2).transpose(0, 2, 1, 3).reshape(t.height // 2, t.width // 2, 4)
    return 100 * (np.abs(blocks - np.asarray(small)[..., None]).min(-1) > 0.01).mean()


def turned(t):
    """The points, turned by 30° about each axis."""
    points = t.points
    for a, b in ((0, 1), (1, 2), (2, 0)):
        points = points.copy()
        x, y = points[:, a].copy(), points[:, b].copy()
        points[:, a], points[:, b] = np.cos(np.pi / 6) * x - np.sin(np.pi / 6) * y, np.sin(np.pi / 6) * x + np.cos(np.pi / 6) * y
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


@program("OpenCV", "place", distribution="opencv-python-headless")
def opencv_(c, t):
    import cv2

    middle = cv2.getDefaultNewCameraMatrix(t.K, (t.width, t.height), True)[0, 2]
    c.place(PIXEL, "`getDefaultNewCameraMatrix`", lambda: middle - (t.width - 1) / 2, 0)
    half = (t.width // 2, t.height // 2)
    for name in ("INTER_AREA", "INTER_LINEAR", "INTER_NEAREST_EXACT"):
        small = lambda: cv2.resize(t.depth, half, interpolation=getattr(cv2, name))
        c.place(EDGE, f"`{name}`", lambda: mixed(t, small()), 0 if "NEAREST" in name else 1.67, 0.01)


@program("Pillow", "place", distribution="pillow")
def pillow_(c, t):
    from PIL import Image

    small = lambda: Image.fromarray(t.depth).resize((t.width // 2, t.height // 2))
    c.place(EDGE, "`resize`, whose default is bicubic", lambda: mixed(t, small()), 5.94, 0.01)


@program("scikit-image", "place")
def skimage_(c, t):
    from skimage.transform import resize

    c.place(EDGE, "`resize`", lambda: mixed(t, resize(t.depth, (t.height // 2, t.width // 2))), 3.98, 0.01)


@program("RealSense", "place", distribution="pyrealsense2")
def realsense_(c, t):
    import pyrealsense2 as rs

    lens = rs.intrinsics()
    lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy = t.width, t.height, t.fx, t.fy, t.cx, t.cy
    first = lambda: rs.rs2_deproject_pixel_to_point(lens, [0, 0], 1.0)[0] * t.fx + t.cx
    c.place(PIXEL, "`rs2_deproject_pixel_to_point`", first, 0, 1e-4)


@program("pycolmap", "place")
def pycolmap_(c, t):
    import pycolmap

    camera = pycolmap.Camera.create_from_model_name(1, "PINHOLE", t.fx, t.width, t.height)
    c.place(PIXEL, "the principal point of a new `Camera`", lambda: camera.principal_point_x - (t.width - 1) / 2, 0.5)


@program("trimesh", "place")
def trimesh_(c, t):
    import tempfile

    import trimesh

    mesh = trimesh.Trimesh(turned(t), t.triangles, process=False)
    c.place(BOX, "`extents`", lambda: mesh.extents.max(), 0.181, 0.001)
    c.place(BOX, "`bounding_box_oriented`", lambda: max(mesh.bounding_box_oriented.primitive.extents), 0.17, 0.001)

    def written():
        mesh.visual.vertex_colors = np.full((len(t.points), 4), [188, 188, 188, 255], np.uint8)
        with tempfile.TemporaryDirectory() as folder:
            mesh.export(os.path.join(folder, "a.glb"))
            return grey(os.path.join(folder, "a.glb"))

    c.place(GREY, "byte, sRGB-encoded", written, 188)


@program("Open3D", "place", distribution="open3d")
def open3d_(c, t):
    import tempfile

    import open3d as o3d

    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(t.K, np.eye(4), t.width, t.height).numpy()
    c.place(PIXEL, "`create_rays_pinhole`", lambda: rays[0, 0, 3] / rays[0, 0, 5] * t.fx + t.cx, 0.5, 1e-3)
    lens = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.K)
    image = o3d.geometry.Image(np.ones(t.depth.shape, np.float32))
    cloud = lambda: np.asarray(o3d.geometry.PointCloud.create_from_depth_image(image, lens, depth_scale=1.0).points)
    c.place(PIXEL, "`create_from_depth_image`", lambda: cloud()[0, 0] * t.fx + t.cx, 0, 1e-3)
    scene = o3d.t.geometry.RaycastingScene()
    corners = np.array([[-9, -9, 1], [9, -9, 1], [9, 9, 1], [-9, 9, 1]], np.float32)
    scene.add_triangles(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    hit = lambda each: float(scene.cast_rays(o3d.core.Tensor(each.astype(np.float32)))["t_hit"].numpy().ravel()[0])
    c.place(RAY, "`t_hit` of `create_rays_pinhole`", lambda: hit(rays[:1, :1]), 1, 1e-5)
    unit = wall(t)[0, 0]
    c.place(RAY, "`t_hit` of rays of length 1", lambda: hit(np.r_[0, 0, 0, unit][None]), 1 / unit[2], 1e-5)
    points = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(turned(t)))
    c.place(BOX, "`get_oriented_bounding_box`", lambda: max(points.get_oriented_bounding_box().extent), 0.186, 0.001)
    c.place(BOX, "`get_minimal_oriented_bounding_box`", lambda: max(points.get_minimal_oriented_bounding_box().extent), 0.17, 0.001)

    def written():
        mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(t.points), o3d.utility.Vector3iVector(t.triangles))
        mesh.vertex_colors = o3d.utility.Vector3dVector(np.full((len(t.points), 3), 188 / 255))
        with tempfile.TemporaryDirectory() as folder:
            o3d.io.write_triangle_mesh(os.path.join(folder, "a.glb"), mesh)
            return 255 * grey(os.path.join(folder, "a.glb"))

    c.place(GREY, "float times 255, sRGB-encoded, against the standard", written, 188, 0.5)
