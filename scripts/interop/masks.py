"""Programs of labels: masks in each of their formats, and ours that they load."""

import os
import shutil
import tempfile

import numpy as np

from .cells import dump
from .truth import apply


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
    c.loads("cuboid", corners=apply(np.reshape(ours["toCamera"], (4, 4)).T, box))


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

    def save(path, shape, drawn=None):
        label = sly.Label(shape, sly.ObjClass("body", type(shape)))
        dump(path, sly.Annotation((t.height, t.width), [label]).to_json(), drawn)

    def polygon(path, corners):
        shape, canvas = sly.Polygon([sly.PointLocation(*each) for each in corners], []), np.zeros((t.height, t.width, 3), np.uint8)
        shape.draw(canvas, color=[255, 255, 255])
        save(path, shape, canvas[..., 0] > 0)

    c.writes(bitmap=lambda path, mask: save(path, sly.Bitmap(mask)), polygon=polygon)
