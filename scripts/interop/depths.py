"""Programs of images and arrays: depth maps, in metres as floats or in whole millimetres, masks and cameras."""

import os

import numpy as np

from .cells import FLIP, dump
from .truth import apply, rigid


def mixed(t, small):
    """The percentage of readings that are farther than a centimetre from all that they come from."""
    rows, columns = t.height // 2, t.width // 2
    blocks = t.depth.reshape(rows, 2, columns, 2).transpose(0, 2, 1, 3).reshape(rows, columns, 4)
    return 100 * (np.abs(blocks - np.asarray(small)[..., None]).min(-1) > 0.01).mean()


def opencv(c, t):
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    def save(path, array, *options):
        named = [getattr(cv2, f"IMWRITE_{each}") if isinstance(each, str) else each for each in options]
        assert cv2.imwrite(path, array, named), "imwrite returned False"

    def calibration(path):
        file = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
        file.write("image_width", t.width)
        file.write("image_height", t.height)
        file.write("camera_matrix", t.K)
        file.write("distortion_coefficients", np.array([[0.05, -0.06, 0.001, 0.0, 0.0]]))
        file.release()

    def contours(path, annotation, **document):
        # They go through the middles of the outermost pixels: COCO's polygons of them are half a pixel smaller all round.
        found, _ = cv2.findContours(t.mask.copy(), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        segmentation = [contour.ravel() for contour in found]
        dump(path, document | {"annotations": [annotation | {"segmentation": segmentation}]})

    c.writes(save=save, calibration=calibration, contours=contours)
    middle = cv2.getDefaultNewCameraMatrix(t.K, (t.width, t.height), True)[0, 2]
    c.loads("pixel", middle=middle - (t.width - 1) / 2)
    for name in ("INTER_AREA", "INTER_LINEAR", "INTER_NEAREST_EXACT"):
        small = cv2.resize(t.depth, (t.width // 2, t.height // 2), interpolation=getattr(cv2, name))
        c.loads("edge", **{name: mixed(t, small)})


def pillow(c, t):
    from PIL import Image

    def save(path, array, mode=None, **options):
        image = Image.fromarray(array)
        (image if mode is None else image.convert(mode)).save(path, **options)

    c.writes(save=save)
    c.loads("edge", resize=mixed(t, Image.fromarray(t.depth).resize((t.width // 2, t.height // 2))))


def scikit_image(c, t):
    from skimage.transform import resize

    c.loads("edge", resize=mixed(t, resize(t.depth, (t.height // 2, t.width // 2))))


def openexr(c, t):
    import OpenEXR

    def save(path, channels, compression="ZIP", type="scanlineimage", **header):
        kind = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "type": getattr(OpenEXR, type), **header}
        OpenEXR.File(kind, channels).write(path)

    def parts(path, parts):
        made = [OpenEXR.Part({"type": OpenEXR.scanlineimage}, channels, name) for name, channels in parts]
        OpenEXR.File(made).write(path)

    c.writes(
        save=save,
        parts=parts,
        tiles=lambda path, channels: save(path, channels, type="tiledimage", tiles=OpenEXR.TileDescription()),
        decreasing=lambda path, channels: save(path, channels, lineOrder=OpenEXR.DECREASING_Y),
    )


def h5py(c, t):
    import h5py

    def save(path):
        with h5py.File(path, "w") as file:
            file["depth"] = t.depth

    c.writes(save=save)


def numpy(c, t):
    entry = t.read("scene_gt.json")["0"][0]
    bop = rigid(np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"]) / 1000)
    c.loads("BOP", placed=apply(bop, t.points))

    ros = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    frames = {"opencv": np.eye(4), "opengl": FLIP, "pytorch3d": np.diag([-1.0, -1, 1, 1]), "ros": ros}
    for frame, to_camera in frames.items():
        given = t.read("poses.json")[frame]
        rows, columns = np.reshape(given["rows"], (4, 4)), np.reshape(given["matrix"], (4, 4))
        placed = apply(to_camera @ rows, t.points / 0.25)
        c.loads("pose", **{f"{frame} rows": placed, f"{frame} columns": columns.T - rows})
