"""Programs that write depth maps: metres as floats, or millimetres as integers, in each of their formats."""

import os

import numpy as np

from .cells import program

# Rounded to millimetres; to half floats.
MM, HALF = {"limitM": 0.0005001}, {"limitM": 0.0005}
EIGHT_BIT = {"refused": "EIGHT_BIT_DEPTH"}
REFUSED = {"refused": "UNSUPPORTED_FORMAT"}


@program("OpenCV", distribution="opencv-python-headless")
def opencv_(c, t):
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    def save(array, *options):
        def write(path):
            assert cv2.imwrite(path, array, *options), "imwrite returned False"

        return write

    holes = np.where(t.depth == 0, np.nan, t.depth)
    c.write("depth", "PNG of millimetres", "depth.png", save(t.mm), **MM)
    c.write("depth", "PNG, compression 0", "depth.png", save(t.mm, [cv2.IMWRITE_PNG_COMPRESSION, 0]), **MM)
    c.write("depth", "TIFF of millimetres", "depth.tiff", save(t.mm), **MM)
    c.write("depth", "TIFF of metres", "depth.tiff", save(t.depth))
    c.write("depth", "TIFF of metres, NaN in holes", "depth.tiff", save(holes))
    c.write("depth", "TIFF of doubles", "depth.tiff", save(t.depth.astype(float)))
    for name in ("NONE", "LZW", "ADOBE_DEFLATE", "PACKBITS"):
        value = getattr(cv2, f"IMWRITE_TIFF_COMPRESSION_{name}", None)
        if value is not None:
            c.write("depth", f"TIFF, {name}", "depth.tiff", save(t.depth, [cv2.IMWRITE_TIFF_COMPRESSION, value]))
    c.write("depth", "PFM", "depth.pfm", save(t.depth))
    c.write("depth", "EXR", "depth.exr", save(t.depth))
    half = [cv2.IMWRITE_EXR_TYPE, cv2.IMWRITE_EXR_TYPE_HALF]
    c.write("depth", "EXR, half", "depth.exr", save(t.depth, half), **HALF)
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"):
        # PXR24 keeps 24 bits of a float.
        limit = {"limitM": 2e-5} if name == "PXR24" else {}
        value = getattr(cv2, f"IMWRITE_EXR_COMPRESSION_{name}")
        c.write("depth", f"EXR, {name}", "depth.exr", save(t.depth, [cv2.IMWRITE_EXR_COMPRESSION, value]), **limit)
    for name in ("B44", "DWAA"):
        value = getattr(cv2, f"IMWRITE_EXR_COMPRESSION_{name}")
        c.write("depth", f"EXR, {name}", "depth.exr", save(t.depth, [cv2.IMWRITE_EXR_COMPRESSION, value]), **REFUSED)
    c.write("depth", "PNG of floats", "depth.png", save(t.depth), **EIGHT_BIT)
    points = np.stack([(np.arange(t.width)[None] - t.cx) / t.fx * t.depth, (np.arange(t.height)[:, None] - t.cy) / t.fy * t.depth, t.depth], 2)
    # OpenCV takes three channels for blue, green and red, and so turns x, y, z round. Version 4 takes them for a picture with a high range.
    lossy = {**REFUSED, "says": "LogLuv"} if c.version.startswith("4") else {"limitM": 1e-6}
    c.write("depth", "TIFF of points", "depth.tiff", save(points[..., ::-1].astype(np.float32)), **lossy)
    c.write("depth", "PGM of 16 bits", "depth.pgm", save(t.mm), **REFUSED)
    c.write("depth", "JPEG 2000", "depth.jp2", save(t.mm), **REFUSED)
    for name in ("yml", "xml", "json"):

        def calibration(path):
            file = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
            file.write("image_width", t.width)
            file.write("image_height", t.height)
            file.write("camera_matrix", t.K)
            file.write("distortion_coefficients", np.array([[0.05, -0.06, 0.001, 0.0, 0.0]]))
            file.release()

        c.write("camera", f"FileStorage, {name}", f"camera.{name}", calibration, warns="distortion")
    c.write("mask", "PNG of 0 and 255", "mask.png", save(t.mask * 255))
    c.write("mask", "PNG of 0 and 1", "mask.png", save(t.mask))
    c.write("mask", "PNG of one bit", "mask.png", save(t.mask * 255, [cv2.IMWRITE_PNG_BILEVEL, 1]))
    c.write("mask", "JPEG", "mask.jpg", save(t.mask * 255), limitPixels=40)
    colours = np.dstack([t.mask * 0, t.mask * 0, t.mask * 255])
    c.write("mask", "PNG, red on black", "mask.png", save(colours))
    contours, _ = cv2.findContours(t.mask.copy(), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    polygons = [contour.reshape(-1).tolist() for contour in contours]

    def coco(path):
        import json

        annotation = {"id": 1, "image_id": 1, "category_id": 1, "segmentation": polygons, "iscrowd": 0}
        images = [{"id": 1, "width": t.width, "height": t.height, "file_name": "rgb.png"}]
        with open(path, "w") as file:
            json.dump({"images": images, "annotations": [annotation], "categories": [{"id": 1, "name": "body"}]}, file)

    # Contours go through the middles of the outermost pixels: COCO's polygons of them are half a pixel smaller all round.
    c.write("mask", "findContours as COCO's polygons", "mask.json", coco, limitPixels=260)


@program("Pillow", distribution="pillow")
def pillow_(c, t):
    from PIL import Image

    def save(array, mode=None, **options):
        image = Image.fromarray(array) if mode is None else Image.fromarray(array).convert(mode)
        return lambda path: image.save(path, **options)

    c.write("depth", "PNG of millimetres", "depth.png", save(t.mm), **MM)
    c.write("depth", "PNG of millimetres, mode I", "depth.png", save(t.mm.astype(np.int32)), **MM)
    c.write("depth", "PNG, optimize", "depth.png", save(t.mm, optimize=True), **MM)
    c.write("depth", "TIFF of millimetres", "depth.tiff", save(t.mm), **MM)
    c.write("depth", "TIFF of millimetres, mode I", "depth.tiff", save(t.mm.astype(np.int32)), **MM)
    c.write("depth", "TIFF of metres", "depth.tiff", save(t.depth))
    for compression in ("tiff_lzw", "tiff_adobe_deflate", "packbits"):
        c.write("depth", f"TIFF, {compression}", "depth.tiff", save(t.depth, compression=compression))
    c.write("depth", "TIFF, big_tiff", "depth.tiff", save(t.depth, big_tiff=True))
    c.write("depth", "PFM", "depth.pfm", save(t.depth))
    c.write("depth", "PNG of 8 bits", "depth.png", save((t.depth * 100).astype(np.uint8)), **EIGHT_BIT)
    mask = t.mask * 255
    c.write("mask", "PNG, L", "mask.png", save(mask))
    c.write("mask", "PNG, 1", "mask.png", save(mask, "1"))
    c.write("mask", "PNG, P", "mask.png", save(t.mask, "P"))
    c.write("mask", "PNG, LA", "mask.png", save(mask, "LA"))
    c.write("mask", "PNG, RGBA, cut out", "mask.png", save(np.dstack([mask // 2 + 90, mask // 3 + 40, mask // 4 + 70, mask])))
    c.write("mask", "PNG, interlace of 16 bits", "mask.png", save(t.mask.astype(np.uint16) * 65535))
    c.write("mask", "JPEG", "mask.jpg", save(mask, quality=95), limitPixels=40)
    c.write("mask", "WebP", "mask.webp", save(mask, lossless=True), refused="UNSUPPORTED_FORMAT")


@program("tifffile")
def tifffile_(c, t):
    import tifffile

    def save(array, **options):
        return lambda path: tifffile.imwrite(path, array, **options)

    c.write("depth", "metres", "depth.tif", save(t.depth))
    c.write("depth", "millimetres", "depth.tif", save(t.mm), **MM)
    c.write("depth", "signed millimetres", "depth.tif", save(t.mm.astype(np.int16)), **MM)
    c.write("depth", "32-bit millimetres", "depth.tif", save(t.mm.astype(np.uint32)), **MM)
    c.write("depth", "half floats", "depth.tif", save(t.depth.astype(np.float16)), **HALF)
    c.write("depth", "doubles", "depth.tif", save(t.depth.astype(float)))
    c.write("depth", "MINISWHITE", "depth.tif", save(t.depth, photometric="miniswhite"))
    c.write("depth", "millimetres, MINISWHITE", "depth.tif", save(t.mm, photometric="miniswhite"), **MM)
    c.write("depth", "big-endian", "depth.tif", save(t.depth, byteorder=">"))
    c.write("depth", "bigtiff", "depth.tif", save(t.depth, bigtiff=True))
    c.write("depth", "ImageJ", "depth.tif", save(t.depth, imagej=True))
    c.write("depth", "OME", "depth.ome.tif", save(t.depth, ome=True))
    c.write("depth", "tiles", "depth.tif", save(t.depth, tile=(32, 48)))
    c.write("depth", "strips of 7 rows", "depth.tif", save(t.depth, rowsperstrip=7))
    c.write("depth", "predictor of integers", "depth.tif", save(t.mm, compression="zlib", predictor=2), **MM)
    c.write("depth", "predictor of floats", "depth.tif", save(t.depth, compression="zlib", predictor=3))
    for compression in ("zlib", "lzw", "packbits"):
        c.write("depth", compression, "depth.tif", save(t.depth, compression=compression))
    for compression in ("zstd", "lzma", "lerc"):
        c.write("depth", compression, "depth.tif", save(t.depth, compression=compression), **REFUSED)
    c.write("depth", "shape 1 × H × W", "depth.tif", save(t.depth[None]))
    c.write("depth", "shape H × W × 1", "depth.tif", save(t.depth[..., None]))
    c.write("depth", "two pages", "depth.tif", save(np.stack([t.depth, t.depth * 2])), refused="UNSUPPORTED_FORMAT", says="2 pages")


@program("imageio")
def imageio_(c, t):
    import imageio.v3 as iio

    c.write("depth", "PNG of millimetres", "depth.png", lambda p: iio.imwrite(p, t.mm), **MM)
    c.write("depth", "TIFF of metres", "depth.tiff", lambda p: iio.imwrite(p, t.depth))
    c.write("depth", "TIFF of millimetres", "depth.tiff", lambda p: iio.imwrite(p, t.mm), **MM)
    c.write("mask", "PNG", "mask.png", lambda p: iio.imwrite(p, t.mask * np.uint8(255)))


@program("OpenEXR")
def openexr_(c, t):
    import OpenEXR

    def save(channels, compression="ZIP", parts=None, **header):
        kind = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": OpenEXR.scanlineimage, **header}
        return lambda path: OpenEXR.File(kind, channels).write(path)

    z = {"Z": t.depth}
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"):
        c.write("depth", f"Z, {name}", "depth.exr", save(z, name), limitM=2e-5 if name == "PXR24" else 1e-7)
    for name in ("B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32", "ZSTD"):
        if hasattr(OpenEXR, f"{name}_COMPRESSION"):
            # B44 leaves floats alone.
            c.write("depth", f"Z, {name}", "depth.exr", save(z, name), **REFUSED)
    c.write("depth", "half", "depth.exr", save({"Z": t.depth.astype(np.float16)}), **HALF)
    c.write("depth", "uint of millimetres", "depth.exr", save({"Z": t.mm.astype(np.uint32)}), **MM)
    for name in ("Y", "depth", "Depth", "ViewLayer.Depth.Z", "depth.V"):
        c.write("depth", f"channel {name}", "depth.exr", save({name: t.depth}))
    grey = np.full((t.height, t.width), 0.5, np.float32)
    c.write("depth", "R, G, B and Z", "depth.exr", save({"R": grey, "G": grey, "B": grey, "Z": t.depth}))
    rgb = np.stack([t.depth] * 3, 2)
    c.write("depth", "depth as R, G and B", "depth.exr", save({"RGB": rgb}))
    tiles = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()} if hasattr(OpenEXR, "TileDescription") else {}
    c.write("depth", "tiles", "depth.exr", save(z, **tiles))
    c.write("depth", "decreasing lines", "depth.exr", save(z, lineOrder=OpenEXR.DECREASING_Y))
    far = np.where(t.depth == 0, np.inf, t.depth)
    c.write("depth", "infinite in holes", "depth.exr", save({"Z": far}))

    def parts(path):
        kinds = [("rgba", {"RGB": rgb}), ("depth", z)]
        OpenEXR.File([OpenEXR.Part({"type": OpenEXR.scanlineimage}, each, name) for name, each in kinds]).write(path)

    c.write("depth", "two parts", "depth.exr", parts)


@program("h5py")
def h5py_(c, t):
    import h5py

    def save(path):
        with h5py.File(path, "w") as file:
            file["depth"] = t.depth

    c.write("depth", "HDF5", "depth.h5", save, refused="UNSUPPORTED_FORMAT", says="HDF5")


@program("NumPy", distribution="numpy")
def numpy_(c, t):
    for name in ("f2", "f4", "f8", ">f4", "u2", ">u2", "i4", "u4", "i8"):
        array = (t.mm if "u" in name or "i" in name else t.depth).astype(name)
        limit = MM if "u" in name or "i" in name else HALF if name == "f2" else {}
        c.write("depth", f"npy of {name}", "depth.npy", lambda p: np.save(p, array), **limit)
    c.write("depth", "npy, Fortran's order", "depth.npy", lambda p: np.save(p, np.asfortranarray(t.depth)))
    for shape in ((1, t.height, t.width), (t.height, t.width, 1), (1, 1, t.height, t.width)):
        c.write("depth", f"npy of {len(shape)} dimensions, {shape.index(1)}", "depth.npy", lambda p: np.save(p, t.depth.reshape(shape)))
    K = {"intrinsics": t.K}
    c.write("depth", "npz", "depth.npz", lambda p: np.savez(p, depth=t.depth))
    c.write("depth", "npz, compressed", "depth.npz", lambda p: np.savez_compressed(p, depth=t.depth, mask=t.mask, **K))
    c.write("depth", "npz without names", "depth.npz", lambda p: np.savez(p, t.depth))
    c.write("depth", "a pickle", "depth.npy", lambda p: np.save(p, np.array([t.depth, None], object)), refused="UNSUPPORTED_FORMAT")
    for name, array in (("bool", t.mask > 0), ("u1", t.mask), ("f4", t.mask.astype(np.float32)), ("i8", t.mask.astype(int))):
        c.write("mask", f"npy of {name}", "mask.npy", lambda p: np.save(p, array))
    c.write("mask", "npy of logits", "mask.npy", lambda p: np.save(p, (t.mask * 20.0 - 10).astype(np.float32)))
    c.write("camera", "npy", "K.npy", lambda p: np.save(p, t.K))
    c.write("camera", "savetxt", "K.txt", lambda p: np.savetxt(p, t.K))
    c.write("camera", "savetxt of %.6f, commas", "K.csv", lambda p: np.savetxt(p, t.K, "%.6f", ","))
    c.write("pose", "savetxt of 4 × 4", "pose.txt", lambda p: np.savetxt(p, t.matrix()))


def rendered(t, near, far):
    """The z-buffer of the truth: what OpenGL stores."""
    z = np.where(t.depth == 0, far, t.depth)
    return (far * (z - near) / (z * (far - near))).astype(np.float32)


@program("PyBullet", distribution="pybullet")
def pybullet_(c, t):
    import pybullet

    near, far = 0.05, 5.0
    client = pybullet.connect(pybullet.DIRECT)
    vertices, indices = t.points.tolist(), t.triangles.ravel().tolist()
    visual = pybullet.createVisualShape(pybullet.GEOM_MESH, vertices=vertices, indices=indices)
    pybullet.createMultiBody(0, -1, visual)
    # OpenGL's camera looks along -z. The software renderer looks through the lower left corner of each pixel.
    view = np.diag([1.0, -1, -1, 1]) @ t.matrix()
    edge = lambda centre, size: 2 * centre / size - 1
    lens = np.zeros((4, 4))
    lens[0, 0], lens[0, 2] = 2 * t.fx / t.width, -edge(t.cx, t.width)
    lens[1, 1], lens[1, 2] = 2 * t.fy / t.height, edge(t.cy + 1, t.height)
    lens[2, 2], lens[2, 3], lens[3, 2] = -(far + near) / (far - near), -2 * far * near / (far - near), -1
    flat = lambda matrix: matrix.T.ravel().tolist()
    image = pybullet.getCameraImage(t.width, t.height, flat(view), flat(lens), renderer=pybullet.ER_TINY_RENDERER)
    buffer, seen = np.asarray(image[3], np.float32).reshape(t.mask.shape), np.asarray(image[4]).reshape(t.mask.shape)
    code = {"depthCode": "z-buffer", "depthNear": near, "depthFar": far}
    # Outlines are drawn a pixel wider.
    limits = {"options": code, "limitM": 1e-4, "only": "mask", "share": 0.97}
    c.write("depth", "z-buffer of getCameraImage", "depth.npy", lambda p: np.save(p, buffer), **limits)
    c.write("mask", "segmentation of getCameraImage", "mask.npy", lambda p: np.save(p, (seen == 0).astype(np.uint8)), limitPixels=260)
    pybullet.disconnect(client)


@program("MuJoCo", distribution="mujoco")
def mujoco_(c, t):
    import mujoco

    # Depth of MuJoCo's renderer needs a display; what it writes itself is the meshes of a model.
    def save(path):
        spec = mujoco.MjSpec()
        spec.add_mesh(name="body", uservert=t.points.ravel(), userface=t.triangles.ravel())
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="body")
        model = spec.compile()
        # A compiled mesh lies in the frame of its inertia.
        turned = np.zeros(9)
        mujoco.mju_quat2Mat(turned, model.mesh_quat[0])
        vertices = model.mesh_vert @ turned.reshape(3, 3).T + model.mesh_pos[0]
        with open(path, "w") as file:
            file.writelines("v {:.9g} {:.9g} {:.9g}\n".format(*v) for v in vertices)
            file.writelines("f {} {} {}\n".format(*(f + 1)) for f in model.mesh_face)

    c.write("mesh", "mesh_vert with mesh_pos and mesh_quat", "mesh.obj", save, limitM=1e-6)


@program("Mitsuba", distribution="mitsuba")
def mitsuba_(c, t):
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    vertices, faces = t.points.astype(np.float32), t.triangles.astype(np.uint32)
    mesh = mitsuba.Mesh("body", len(vertices), len(faces))
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"], parameters["faces"] = vertices.ravel(), faces.ravel()
    parameters.update()
    c.write("mesh", "write_ply", "mesh.ply", lambda p: mesh.write_ply(p))
    c.write("depth", "EXR of a Bitmap", "depth.exr", lambda p: mitsuba.Bitmap(t.depth[..., None]).write(p))
    c.write("depth", "PFM of a Bitmap", "depth.pfm", lambda p: mitsuba.Bitmap(t.depth[..., None]).write(p))
    c.write("depth", "PNG of a Bitmap of 16 bits", "depth.png", lambda p: mitsuba.Bitmap(t.mm[..., None]).write(p), **MM)
