"""Programs of pictures: depth maps and masks in each of their formats, labels, and ours that they load."""

import os
import shutil
import tempfile

import numpy as np

from .cells import FLIP, ROS, dump
from .truth import apply, rigid


def opencv(c, t):
    import cv2

    def calibration(path):
        camera = {"image_width": t.width, "image_height": t.height, "camera_matrix": t.K}
        file = cv2.FileStorage(path, cv2.FILE_STORAGE_WRITE)
        for name, value in camera.items():
            file.write(name, value)
        file.write("distortion_coefficients", np.array([[0.05, -0.06, 0.001, 0.0, 0.0]]))
        file.release()

    c.writes(calibration=calibration)
    middle = cv2.getDefaultNewCameraMatrix(t.K, (t.width, t.height), True)[0, 2]
    c.loads("pixel", middle=middle - (t.width - 1) / 2)


def pillow(c, t):
    from PIL import Image

    def save(path, array, mode=None, **options):
        image = Image.fromarray(array)
        (image if mode is None else image.convert(mode)).save(path, **options)

    c.writes(save=save)


def openexr(c, t):
    import OpenEXR

    plain = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    c.writes(save=lambda path, channels, **header: OpenEXR.File(plain | header, channels).write(path))


def numpy(c, t):
    entry = t.read("scene_gt.json")["0"][0]
    bop = rigid(np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"]) / 1000)
    c.loads("BOP", placed=apply(bop, t.points))

    frames = {"opencv": np.eye(4), "opengl": FLIP, "pytorch3d": np.diag([-1.0, -1, 1, 1]), "ros": ROS}
    for frame, to_camera in frames.items():
        given = t.read("poses.json")[frame]
        rows, columns = np.reshape(given["rows"], (4, 4)), np.reshape(given["matrix"], (4, 4))
        placed = apply(to_camera @ rows, t.points / 0.25)
        c.loads("pose", **{f"{frame} rows": placed, f"{frame} columns": columns.T - rows})


def pycocotools(c, t):
    from pycocotools import mask
    from pycocotools.coco import COCO

    def load(name):
        coco = COCO(t.ours(name))
        return coco.annToMask(coco.loadAnns([1])[0])

    ours, theirs = t.read("mask.json"), mask.encode(np.asfortranarray(t.mask))
    same = theirs["counts"].decode() == ours["counts"]
    c.loads("mask", decode=mask.decode(ours), annotation=load("coco.json"), crowd=load("coco-crowd.json"), same=same)


def cvat(c, t):
    from cvat_sdk import models
    from scipy.spatial.transform import Rotation

    # CVAT draws with three.js: a box of this size, turned by Euler angles x, y, z of its default order.
    ours = t.read("cuboid.json")
    shape = models.LabeledShapeRequest(type="cuboid", frame=0, label_id=1, points=ours["points"])
    center, angles, size = np.array(shape.to_dict()["points"][:9]).reshape(3, 3)
    corners = (np.indices((2, 2, 2)).reshape(3, -1).T - 0.5) * size
    box = Rotation.from_euler("XYZ", angles).apply(corners) + center
    c.loads("cuboid", corners=apply(ROS, box))


def datumaro(c, t):
    import datumaro as dm

    image = dm.Image.from_numpy(data=np.zeros((t.height, t.width, 3), np.uint8))
    # MOTS needs the number of a track.
    mask = dm.Mask(t.mask.astype(bool), label=0, id=1, attributes={"track_id": 1})
    item = dm.DatasetItem("rgb", media=image, annotations=[mask])
    dataset = dm.Dataset.from_iterable([item], categories=["body"])

    def save(path, format, pattern):
        with tempfile.TemporaryDirectory() as folder:
            dataset.export(folder, format, save_media=True)
            found = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names]
            shutil.copy(next(each for each in sorted(found) if pattern in each), path)

    def load(name):
        with tempfile.TemporaryDirectory() as folder:
            for each in ("annotations", "images"):
                os.makedirs(os.path.join(folder, each))
            shutil.copy(t.ours(name), os.path.join(folder, "annotations", "instances_train.json"))
            [found] = list(dm.Dataset.import_from(folder, "coco_instances"))
            return found.annotations[0].image.astype(int)

    c.writes(save=save)
    c.loads("mask", annotation=load("coco.json"), crowd=load("coco-crowd.json"))


def supervisely(c, t):
    import supervisely as sly

    def save(path, shape):
        label = sly.Label(shape, sly.ObjClass("body", type(shape)))
        dump(path, sly.Annotation((t.height, t.width), [label]).to_json())

    outline = [sly.PointLocation(v, u) for u, v in t.outline]
    c.writes(bitmap=lambda path, mask: save(path, sly.Bitmap(mask)), polygon=lambda path: save(path, sly.Polygon(outline, [])))
