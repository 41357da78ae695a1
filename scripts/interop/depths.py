"""Programs of images and arrays: depth maps, in metres as floats or in whole millimetres, masks and cameras."""

import os

import numpy as np

from .cells import FLIP, MM, REFUSED, apply, dump, program, rigid
from .masks import coco_of
from .places import EDGE, PIXEL, mixed

# Rounded to half floats; to the 24 bits of PXR24.
HALF, BITS_24 = {"limitM": 0.0005}, {"limitM": 2e-5}
EIGHT_BIT = {"refused": "EIGHT_BIT_DEPTH"}


@program("OpenCV")
def opencv_(c, t):
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    def save(path, array, *options):
        named = [getattr(cv2, f"IMWRITE_{each}") if isinstance(each, str) else each for each in options]
        assert cv2.imwrite(path, array, named), "imwrite returned False"

    # OpenCV takes three channels for blue, green and red, and so turns x, y, z round. Version 4 takes them for a picture
    # with a high range.
    v, u = np.mgrid[: t.height, : t.width]
    points = np.stack([t.depth, (v - t.cy) / t.fy * t.depth, (u - t.cx) / t.fx * t.depth], 2).astype(np.float32)
    lossy = REFUSED | {"says": "LogLuv"} if c.version.startswith("4") else {"limitM": 1e-6}
    c.write("depth", "PNG of millimetres", "depth.png", MM, save, t.mm)
    c.write("depth", "PNG, compression 0", "depth.png", MM, save, t.mm, "PNG_COMPRESSION", 0)
    c.write("depth", "PNG of floats", "depth.png", EIGHT_BIT, save, t.depth)
    c.write("depth", "TIFF of millimetres", "depth.tiff", MM, save, t.mm)
    c.write("depth", "TIFF of metres", "depth.tiff", {}, save, t.depth)
    c.write("depth", "TIFF of metres, NaN in holes", "depth.tiff", {}, save, np.where(t.depth == 0, np.nan, t.depth))
    c.write("depth", "TIFF of doubles", "depth.tiff", {}, save, t.depth.astype(float))
    c.write("depth", "TIFF of points", "depth.tiff", lossy, save, points)
    for name in ("NONE", "LZW", "ADOBE_DEFLATE", "PACKBITS"):
        if hasattr(cv2, f"IMWRITE_TIFF_COMPRESSION_{name}"):
            compressed = t.depth, "TIFF_COMPRESSION", f"TIFF_COMPRESSION_{name}"
            c.write("depth", f"TIFF, {name}", "depth.tiff", {}, save, *compressed)
    c.write("depth", "PFM", "depth.pfm", {}, save, t.depth)
    c.write("depth", "EXR", "depth.exr", {}, save, t.depth)
    c.write("depth", "EXR, half", "depth.exr", HALF, save, t.depth, "EXR_TYPE", "EXR_TYPE_HALF")
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "DWAA"):
        expect = {"PXR24": BITS_24, "B44": REFUSED, "DWAA": REFUSED}.get(name, {})
        compressed = t.depth, "EXR_COMPRESSION", f"EXR_COMPRESSION_{name}"
        c.write("depth", f"EXR, {name}", "depth.exr", expect, save, *compressed)
    c.write("depth", "PGM of 16 bits", "depth.pgm", REFUSED, save, t.mm)
    c.write("depth", "JPEG 2000", "depth.jp2", REFUSED, save, t.mm)

    def calibration(path):
        file = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
        file.write("image_width", t.width)
        file.write("image_height", t.height)
        file.write("camera_matrix", t.K)
        file.write("distortion_coefficients", np.array([[0.05, -0.06, 0.001, 0.0, 0.0]]))
        file.release()

    for name in ("yml", "xml", "json"):
        c.write("camera", f"FileStorage, {name}", f"camera.{name}", {"warns": "distortion"}, calibration)
    c.write("mask", "PNG of 0 and 255", "mask.png", {}, save, t.mask * 255)
    c.write("mask", "PNG of 0 and 1", "mask.png", {}, save, t.mask)
    c.write("mask", "PNG of one bit", "mask.png", {}, save, t.mask * 255, "PNG_BILEVEL", 1)
    c.write("mask", "JPEG", "mask.jpg", {"limitPixels": 40}, save, t.mask * 255)
    c.write("mask", "PNG, red on black", "mask.png", {}, save, t.mask[..., None] * np.uint8([0, 0, 255]))
    # Contours go through the middles of the outermost pixels: COCO's polygons of them are half a pixel smaller all round.
    contours, _ = cv2.findContours(t.mask.copy(), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    polygons = coco_of(t, [contour.ravel().tolist() for contour in contours])
    c.write("mask", "findContours as COCO's polygons", "mask.json", {"limitPixels": 260}, dump, polygons)

    middle = cv2.getDefaultNewCameraMatrix(t.K, (t.width, t.height), True)[0, 2]
    c.place(PIXEL, "`getDefaultNewCameraMatrix`", middle - (t.width - 1) / 2, 0)
    for name, share in (("INTER_AREA", 1.67), ("INTER_LINEAR", 1.67), ("INTER_NEAREST_EXACT", 0)):
        small = cv2.resize(t.depth, (t.width // 2, t.height // 2), interpolation=getattr(cv2, name))
        c.place(EDGE, f"`{name}`", mixed(t, small), share, 0.01)


@program("Pillow")
def pillow_(c, t):
    from PIL import Image

    def save(path, array, mode=None, **options):
        image = Image.fromarray(array)
        (image if mode is None else image.convert(mode)).save(path, **options)

    mask = t.mask * 255
    cut_out = np.dstack([mask // 2 + 90, mask // 3 + 40, mask // 4 + 70, mask])
    c.write("depth", "PNG of millimetres", "depth.png", MM, save, t.mm)
    c.write("depth", "PNG of millimetres, mode I", "depth.png", MM, save, t.mm.astype(np.int32))
    c.write("depth", "PNG, optimize", "depth.png", MM, save, t.mm, optimize=True)
    c.write("depth", "PNG of 8 bits", "depth.png", EIGHT_BIT, save, (t.depth * 100).astype(np.uint8))
    c.write("depth", "TIFF of millimetres", "depth.tiff", MM, save, t.mm)
    c.write("depth", "TIFF of millimetres, mode I", "depth.tiff", MM, save, t.mm.astype(np.int32))
    c.write("depth", "TIFF of metres", "depth.tiff", {}, save, t.depth)
    for compression in ("tiff_lzw", "tiff_adobe_deflate", "packbits"):
        c.write("depth", f"TIFF, {compression}", "depth.tiff", {}, save, t.depth, compression=compression)
    c.write("depth", "TIFF, big_tiff", "depth.tiff", {}, save, t.depth, big_tiff=True)
    c.write("depth", "PFM", "depth.pfm", {}, save, t.depth)
    c.write("mask", "PNG, L", "mask.png", {}, save, mask)
    c.write("mask", "PNG, 1", "mask.png", {}, save, mask, "1")
    c.write("mask", "PNG, P", "mask.png", {}, save, t.mask, "P")
    c.write("mask", "PNG, LA", "mask.png", {}, save, mask, "LA")
    c.write("mask", "PNG, RGBA, cut out", "mask.png", {}, save, cut_out)
    c.write("mask", "PNG, interlace of 16 bits", "mask.png", {}, save, t.mask.astype(np.uint16) * 65535)
    c.write("mask", "JPEG", "mask.jpg", {"limitPixels": 40}, save, mask, quality=95)
    c.write("mask", "WebP", "mask.webp", REFUSED, save, mask, lossless=True)
    small = Image.fromarray(t.depth).resize((t.width // 2, t.height // 2))
    c.place(EDGE, "`resize`, whose default is bicubic", mixed(t, small), 5.94, 0.01)


@program("tifffile")
def tifffile_(c, t):
    import tifffile

    save = tifffile.imwrite
    two = np.stack([t.depth, t.depth * 2])
    c.write("depth", "metres", "depth.tif", {}, save, t.depth)
    c.write("depth", "millimetres", "depth.tif", MM, save, t.mm)
    c.write("depth", "signed millimetres", "depth.tif", MM, save, t.mm.astype(np.int16))
    c.write("depth", "32-bit millimetres", "depth.tif", MM, save, t.mm.astype(np.uint32))
    c.write("depth", "half floats", "depth.tif", HALF, save, t.depth.astype(np.float16))
    c.write("depth", "doubles", "depth.tif", {}, save, t.depth.astype(float))
    c.write("depth", "MINISWHITE", "depth.tif", {}, save, t.depth, photometric="miniswhite")
    c.write("depth", "millimetres, MINISWHITE", "depth.tif", MM, save, t.mm, photometric="miniswhite")
    c.write("depth", "big-endian", "depth.tif", {}, save, t.depth, byteorder=">")
    c.write("depth", "bigtiff", "depth.tif", {}, save, t.depth, bigtiff=True)
    c.write("depth", "ImageJ", "depth.tif", {}, save, t.depth, imagej=True)
    c.write("depth", "OME", "depth.ome.tif", {}, save, t.depth, ome=True)
    c.write("depth", "tiles", "depth.tif", {}, save, t.depth, tile=(32, 48))
    c.write("depth", "strips of 7 rows", "depth.tif", {}, save, t.depth, rowsperstrip=7)
    c.write("depth", "predictor of integers", "depth.tif", MM, save, t.mm, compression="zlib", predictor=2)
    c.write("depth", "predictor of floats", "depth.tif", {}, save, t.depth, compression="zlib", predictor=3)
    c.write("depth", "shape 1 × H × W", "depth.tif", {}, save, t.depth[None])
    c.write("depth", "shape H × W × 1", "depth.tif", {}, save, t.depth[..., None])
    c.write("depth", "two pages", "depth.tif", REFUSED | {"says": "2 pages"}, save, two)
    for compression in ("zlib", "lzw", "packbits", "zstd", "lzma", "lerc"):
        expect = REFUSED if compression in ("zstd", "lzma", "lerc") else {}
        c.write("depth", compression, "depth.tif", expect, save, t.depth, compression=compression)


@program("imageio")
def imageio_(c, t):
    import imageio.v3 as iio

    c.write("depth", "PNG of millimetres", "depth.png", MM, iio.imwrite, t.mm)
    c.write("depth", "TIFF of metres", "depth.tiff", {}, iio.imwrite, t.depth)
    c.write("depth", "TIFF of millimetres", "depth.tiff", MM, iio.imwrite, t.mm)
    c.write("mask", "PNG", "mask.png", {}, iio.imwrite, t.mask * np.uint8(255))


@program("scikit-image")
def skimage_(c, t):
    from skimage.io import imsave
    from skimage.transform import resize

    c.write("depth", "png of millimetres", "depth.png", MM, imsave, t.mm, check_contrast=False)
    c.write("depth", "tiff of metres", "depth.tiff", {}, imsave, t.depth, check_contrast=False)
    c.write("mask", "png of booleans", "mask.png", {}, imsave, t.mask > 0, check_contrast=False)
    c.place(EDGE, "`resize`", mixed(t, resize(t.depth, (t.height // 2, t.width // 2))), 3.98, 0.01)


@program("OpenEXR")
def openexr_(c, t):
    import OpenEXR

    def save(path, channels, compression="ZIP", **header):
        kind = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": OpenEXR.scanlineimage, **header}
        OpenEXR.File(kind, channels).write(path)

    def parts(path):
        kinds = [("rgba", {"RGB": rgb}), ("depth", z)]
        OpenEXR.File([OpenEXR.Part({"type": OpenEXR.scanlineimage}, each, name) for name, each in kinds]).write(path)

    z, rgb = {"Z": t.depth}, np.stack([t.depth] * 3, 2)
    grey = np.full((t.height, t.width), 0.5, np.float32)
    tiles = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"):
        c.write("depth", f"Z, {name}", "depth.exr", BITS_24 if name == "PXR24" else {}, save, z, name)
    for name in ("B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32", "ZSTD"):
        # B44 leaves floats alone.
        c.write("depth", f"Z, {name}", "depth.exr", REFUSED, save, z, name)
    for name in ("Y", "depth", "Depth", "ViewLayer.Depth.Z", "depth.V"):
        c.write("depth", f"channel {name}", "depth.exr", {}, save, {name: t.depth})
    c.write("depth", "half", "depth.exr", HALF, save, {"Z": t.depth.astype(np.float16)})
    c.write("depth", "uint of millimetres", "depth.exr", MM, save, {"Z": t.mm.astype(np.uint32)})
    c.write("depth", "R, G, B and Z", "depth.exr", {}, save, {"R": grey, "G": grey, "B": grey, "Z": t.depth})
    c.write("depth", "depth as R, G and B", "depth.exr", {}, save, {"RGB": rgb})
    c.write("depth", "tiles", "depth.exr", {}, save, z, **tiles)
    c.write("depth", "decreasing lines", "depth.exr", {}, save, z, lineOrder=OpenEXR.DECREASING_Y)
    c.write("depth", "infinite in holes", "depth.exr", {}, save, {"Z": np.where(t.depth == 0, np.inf, t.depth)})
    c.write("depth", "two parts", "depth.exr", {}, parts)


@program("h5py")
def h5py_(c, t):
    import h5py

    def save(path):
        with h5py.File(path, "w") as file:
            file["depth"] = t.depth

    c.write("depth", "HDF5", "depth.h5", REFUSED | {"says": "HDF5"}, save)


@program("NumPy")
def numpy_(c, t):
    for name in ("f2", "f4", "f8", ">f4"):
        c.write("depth", f"npy of {name}", "depth.npy", HALF if name == "f2" else {}, np.save, t.depth.astype(name))
    for name in ("u2", ">u2", "i4", "u4", "i8"):
        c.write("depth", f"npy of {name}", "depth.npy", MM, np.save, t.mm.astype(name))
    c.write("depth", "npy, Fortran's order", "depth.npy", {}, np.save, np.asfortranarray(t.depth))
    c.write("depth", "npy of 3 dimensions, 0", "depth.npy", {}, np.save, t.depth[None])
    c.write("depth", "npy of 3 dimensions, 2", "depth.npy", {}, np.save, t.depth[..., None])
    c.write("depth", "npy of 4 dimensions, 0", "depth.npy", {}, np.save, t.depth[None, None])
    c.write("depth", "npz", "depth.npz", {}, np.savez, depth=t.depth)
    whole = {"depth": t.depth, "mask": t.mask, "intrinsics": t.K}
    c.write("depth", "npz, compressed", "depth.npz", {}, np.savez_compressed, **whole)
    c.write("depth", "npz without names", "depth.npz", {}, np.savez, t.depth)
    c.write("depth", "a pickle", "depth.npy", REFUSED, np.save, np.array([t.depth, None], object))
    for name in ("bool", "u1", "f4", "i8"):
        c.write("mask", f"npy of {name}", "mask.npy", {}, np.save, t.mask.astype(name))
    c.write("mask", "npy of logits", "mask.npy", {}, np.save, (t.mask * 20.0 - 10).astype(np.float32))
    c.write("camera", "npy", "K.npy", {}, np.save, t.K)
    c.write("camera", "savetxt", "K.txt", {}, np.savetxt, t.K)
    c.write("camera", "savetxt of %.6f, commas", "K.csv", {}, np.savetxt, t.K, "%.6f", ",")
    c.write("pose", "savetxt of 4 × 4", "pose.txt", {}, np.savetxt, t.matrix)

    entry = t.read("scene_gt.json")["0"][0]
    bop = rigid(np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"]) / 1000)
    c.points("BOP", "scene_gt.json, rows and millimetres", apply(bop, t.points), t.placed)
    ros = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    frames = {"opencv": np.eye(4), "opengl": FLIP, "pytorch3d": np.diag([-1.0, -1, 1, 1]), "ros": ros}
    for frame, to_camera in frames.items():
        given = t.read("poses.json")[frame]
        rows, columns = np.reshape(given["rows"], (4, 4)), np.reshape(given["matrix"], (4, 4))
        c.points("pose", f"{frame}: rows", apply(to_camera @ rows, t.points / 0.25), t.placed)
        c.measure("pose", f"{frame}: columns are its transpose", columns.T - rows, 0)
