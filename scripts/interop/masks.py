"""Programs of labels: masks in each of their formats, and ours that they load."""

import os
import shutil
import tempfile

import numpy as np

from .cells import REFUSED, apply, dump, program, rotation


def coco_of(t, segmentation, crowd=0):
    """A file of COCO with one annotation."""
    image = {"id": 7, "width": t.width, "height": t.height, "file_name": "rgb.png"}
    annotation = {"id": 1, "image_id": 7, "category_id": 1, "iscrowd": crowd, "segmentation": segmentation}
    return {"images": [image], "annotations": [annotation], "categories": [{"id": 1, "name": "body"}]}


def box_of(t):
    """The columns and rows of the mask: left, top, right and bottom, which are inside."""
    rows, columns = np.nonzero(t.mask)
    return [int(each) for each in (columns.min(), rows.min(), columns.max(), rows.max())]


@program("pycocotools")
def pycocotools_(c, t):
    from pycocotools import mask
    from pycocotools.coco import COCO

    encoded = mask.encode(np.asfortranarray(t.mask))
    rle = {"size": encoded["size"], "counts": encoded["counts"].decode()}
    # The runs of columns, as `annToRLE` takes them.
    ends = np.flatnonzero(np.diff(t.mask.ravel(order="F"), prepend=0)).tolist()
    plain = {"size": [t.height, t.width], "counts": np.diff([0, *ends, t.mask.size]).tolist()}
    sam = {"segmentation": rle, "area": int(t.mask.sum()), "predicted_iou": 0.9, "stability_score": 0.95}
    c.write("mask", "encode", "mask.json", {}, dump, rle)
    c.write("mask", "runs as numbers", "mask.json", {}, dump, plain)
    c.write("mask", "annotation with encode", "mask.json", {}, dump, coco_of(t, rle))
    c.write("mask", "crowd annotation", "mask.json", {}, dump, coco_of(t, plain, 1))
    c.write("mask", "SAM's list of masks", "mask.json", {}, dump, [sam])
    c.write("mask", "encode of an array with an axis", "mask.json", {}, dump, [rle])

    def annotation(name):
        coco = COCO(t.ours(name))
        return coco.annToMask(coco.loadAnns([1])[0])

    ours = t.read("mask.json")
    c.measure("mask", "decode of toCocoRle, pixels", (mask.decode(ours) != t.mask).sum(), 0)
    c.measure("mask", "annotation, compressed, pixels", (annotation("coco.json") != t.mask).sum(), 0)
    c.measure("mask", "crowd, runs as numbers, pixels", (annotation("coco-crowd.json") != t.mask).sum(), 0)
    c.measure("mask", "the same letters as encode", rle["counts"] != ours["counts"], 0)


@program("CVAT")
def cvat_(c, t):
    from cvat_sdk import masks, models

    left, top, right, bottom = box_of(t)
    whole = masks.encode_mask(t.mask.astype(bool))
    boxed = masks.encode_mask(t.mask.astype(bool), [left, top, right + 1, bottom + 1])
    c.write("mask", "encode_mask", "mask.json", {"rle": "cvat"}, dump, whole)
    c.write("mask", "encode_mask with a box", "mask.json", {"rle": "cvat"}, dump, boxed)

    # CVAT draws with three.js: a box of this size, turned by Euler angles x, y, z of its default order.
    ours = t.read("cuboid.json")
    shape = models.LabeledShapeRequest(type="cuboid", frame=0, label_id=1, points=ours["points"])
    center, angles, size = np.array(shape.to_dict()["points"][:9]).reshape(3, 3)
    x, y, z = (rotation([*np.sin(angle / 2) * axis, np.cos(angle / 2)]) for angle, axis in zip(angles, np.eye(3)))
    box = (np.indices((2, 2, 2)).reshape(3, -1).T - 0.5) * size @ (x @ y @ z).T + center
    corners = apply(np.reshape(ours["toCamera"], (4, 4)).T, box)
    c.points("cuboid", "points of a shape", corners, np.reshape(ours["corners"], (-1, 3)))


@program("Label Studio")
def label_studio(c, t):
    from label_studio_sdk.converter import brush

    rgba = np.repeat(t.mask.ravel() * 255, 4).astype(np.uint8)
    rle = {"mask2rle": brush.mask2rle(t.mask * 255), "encode_rle": brush.encode_rle(rgba)}
    for name, numbers in rle.items():
        c.write("mask", name, "mask.json", {"rle": "label-studio"}, dump, numbers)


@program("LabelMe")
def labelme_(c, t):
    from labelme import utils

    left, top, right, bottom = box_of(t)
    part = t.mask[top : bottom + 1, left : right + 1].astype(bool)
    common = {"label": "body", "flags": {}, "group_id": None, "description": ""}
    corners = [[float(left), float(top)], [float(right), float(bottom)]]
    shape = common | {"points": corners, "shape_type": "mask", "mask": utils.img_arr_to_b64(part)}
    triangle = common | {"points": [[20.5, 30.5], [130.0, 40.0], [60.0, 100.0]], "shape_type": "polygon"}
    size = {"imageHeight": t.height, "imageWidth": t.width}
    document = {"version": c.version, "flags": {}, "imagePath": "rgb.png", "imageData": None, **size}
    c.write("mask", "shape of a mask", "mask.json", {}, dump, document | {"shapes": [shape]})
    # LabelMe fills with Pillow, which takes the outline for inside.
    drawn = utils.shape_to_mask((t.height, t.width), triangle["points"], "polygon")
    c.against("polygon, against shape_to_mask", document | {"shapes": [triangle]}, drawn, 320)


@program("Datumaro")
def datumaro_(c, t):
    import datumaro as dm

    image = dm.Image.from_numpy(data=np.zeros((t.height, t.width, 3), np.uint8))
    item = dm.DatasetItem("rgb", media=image, annotations=[dm.Mask(t.mask.astype(bool), label=0, id=1)])
    dataset = dm.Dataset.from_iterable([item], categories=["body"])

    def save(path, format, pattern):
        with tempfile.TemporaryDirectory() as folder:
            dataset.export(folder, format, save_media=True)
            found = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names]
            shutil.copy(next(each for each in sorted(found) if pattern in each), path)

    c.write("mask", "COCO's instances", "mask.json", {}, save, "coco_instances", "instances")
    c.write("mask", "VOC's segmentation of classes", "mask.png", {}, save, "voc_segmentation", "SegmentationClass/")
    c.write("mask", "VOC's segmentation of objects", "mask.png", {}, save, "voc_segmentation", "SegmentationObject/")
    c.write("mask", "Cityscapes, labelIds", "mask.png", {}, save, "cityscapes", "labelIds")
    c.write("mask", "CVAT's XML", "mask.xml", REFUSED, save, "cvat", ".xml")
    c.write("mask", "Datumaro's own JSON", "mask.json", {}, save, "datumaro", "annotations/")
    c.write("mask", "CamVid", "mask.png", {}, save, "camvid", "annot/")
    c.write("mask", "KITTI's instances", "mask.png", {}, save, "kitti_segmentation", "instance/")
    c.write("mask", "MOTS's PNG", "mask.png", {}, save, "mots_png", "instances/")

    for variant, name in (("COCO, compressed, pixels", "coco.json"), ("COCO, crowd, pixels", "coco-crowd.json")):
        with tempfile.TemporaryDirectory() as folder:
            for each in ("annotations", "images"):
                os.makedirs(os.path.join(folder, each))
            shutil.copy(t.ours(name), os.path.join(folder, "annotations", "instances_train.json"))
            [found] = list(dm.Dataset.import_from(folder, "coco_instances"))
            c.measure("mask", variant, (found.annotations[0].image.astype(bool) != t.mask).sum(), 0)


@program("Supervisely")
def supervisely_(c, t):
    import supervisely as sly

    def document(shape):
        label = sly.Label(shape, sly.ObjClass("body", type(shape)))
        return sly.Annotation((t.height, t.width), [label]).to_json()

    c.write("mask", "Bitmap", "mask.json", {}, dump, document(sly.Bitmap(t.mask.astype(bool))))
    exterior = [sly.PointLocation(*each) for each in [(20, 30), (60, 130), (110, 40)]]
    polygon, canvas = sly.Polygon(exterior, []), np.zeros((t.height, t.width, 3), np.uint8)
    polygon.draw(canvas, color=[255, 255, 255])
    c.against("Polygon, against its own drawing", document(polygon), canvas[..., 0] > 0, 320)
