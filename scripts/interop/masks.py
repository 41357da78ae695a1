"""Programs that write masks."""

import json

import numpy as np

from .cells import program


def dump(content):
    def write(path):
        with open(path, "w") as file:
            json.dump(content() if callable(content) else content, file)

    return write


def file_of(t, segmentation, crowd=0):
    """A file of COCO with one annotation."""
    image = {"id": 7, "width": t.width, "height": t.height, "file_name": "rgb.png"}
    annotation = {"id": 1, "image_id": 7, "category_id": 1, "iscrowd": crowd, "segmentation": segmentation}
    return {"images": [image], "annotations": [annotation], "categories": [{"id": 1, "name": "body"}]}


@program("pycocotools")
def pycocotools_(c, t):
    from pycocotools import mask

    def rle():
        encoded = mask.encode(np.asfortranarray(t.mask))
        return {"size": encoded["size"], "counts": encoded["counts"].decode()}

    def plain():
        # The runs of columns, as `annToRLE` takes them.
        flat = np.concatenate([[0], t.mask.ravel(order="F")])
        starts = np.flatnonzero(np.diff(flat)).tolist()
        return {"size": [t.height, t.width], "counts": np.diff([0, *starts, t.mask.size]).tolist()}

    sam = lambda: [{"segmentation": rle(), "area": int(t.mask.sum()), "predicted_iou": 0.9, "stability_score": 0.95}]
    c.write("mask", "encode", "mask.json", dump(rle))
    c.write("mask", "runs as numbers", "mask.json", dump(plain))
    c.write("mask", "annotation with encode", "mask.json", dump(lambda: file_of(t, rle())))
    c.write("mask", "crowd annotation", "mask.json", dump(lambda: file_of(t, plain(), 1)))
    c.write("mask", "SAM's list of masks", "mask.json", dump(sam))
    c.write("mask", "encode of an array with an axis", "mask.json", dump(lambda: [rle()]))


@program("CVAT", distribution="cvat-sdk")
def cvat_(c, t):
    from cvat_sdk import masks

    rows, columns = np.flatnonzero(t.mask.any(1)), np.flatnonzero(t.mask.any(0))
    box = [int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1])]
    points = lambda: [float(each) for each in masks.encode_mask(t.mask.astype(bool))]
    c.write("mask", "encode_mask", "mask.json", dump(points), rle="cvat")
    boxed = lambda: [float(each) for each in masks.encode_mask(t.mask.astype(bool), [box[0], box[1], box[2] + 1, box[3] + 1])]
    c.write("mask", "encode_mask with a box", "mask.json", dump(boxed), rle="cvat")


@program("Label Studio", distribution="label-studio-sdk")
def label_studio(c, t):
    from label_studio_sdk.converter import brush

    rle = lambda: [int(each) for each in brush.mask2rle(t.mask * 255)]
    c.write("mask", "mask2rle", "mask.json", dump(rle), rle="label-studio")
    rgba = np.repeat(t.mask.ravel() * 255, 4).astype(np.uint8)
    encoded = lambda: [int(each) for each in brush.encode_rle(rgba)]
    c.write("mask", "encode_rle", "mask.json", dump(encoded), rle="label-studio")


@program("LabelMe", distribution="labelme")
def labelme_(c, t):
    from labelme import utils

    rows, columns = np.flatnonzero(t.mask.any(1)), np.flatnonzero(t.mask.any(0))
    (top, bottom), (left, right) = (rows[0], rows[-1]), (columns[0], columns[-1])
    part = t.mask[top : bottom + 1, left : right + 1].astype(bool)
    image = utils.img_arr_to_b64(part)
    shape = {
        "label": "body",
        "points": [[float(left), float(top)], [float(right), float(bottom)]],
        "shape_type": "mask",
        "mask": image,
        "flags": {},
        "group_id": None,
        "description": "",
    }
    document = {"version": c.version, "flags": {}, "shapes": [shape], "imagePath": "rgb.png", "imageData": None}
    document |= {"imageHeight": t.height, "imageWidth": t.width}
    c.write("mask", "shape of a mask", "mask.json", dump(document))
    triangle = {**shape, "shape_type": "polygon", "points": [[20.5, 30.5], [130.0, 40.0], [60.0, 100.0]]}
    triangle.pop("mask")

    def polygon(path):
        dump({**document, "shapes": [triangle]})(path)
        drawn = utils.shape_to_mask((t.height, t.width), triangle["points"], "polygon")
        np.save(path.replace("mask.json", "expected.npy"), drawn.astype(np.uint8))

    # LabelMe fills with Pillow, which takes the outline for inside.
    c.write("mask", "polygon, against shape_to_mask", "mask.json", polygon, against="expected.npy", limitPixels=320)


@program("Datumaro", distribution="datumaro")
def datumaro_(c, t):
    import os
    import shutil
    import tempfile

    import datumaro as dm

    def save(format, pattern):
        def write(path):
            image = dm.Image.from_numpy(data=np.zeros((t.height, t.width, 3), np.uint8))
            item = dm.DatasetItem("rgb", media=image, annotations=[dm.Mask(t.mask.astype(bool), label=0, id=1)])
            dataset = dm.Dataset.from_iterable([item], categories=["body"])
            with tempfile.TemporaryDirectory() as folder:
                dataset.export(folder, format, save_media=True)
                found = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names]
                shutil.copy(next(each for each in sorted(found) if pattern in each), path)

        return write

    c.write("mask", "COCO's instances", "mask.json", save("coco_instances", "instances"))
    c.write("mask", "VOC's segmentation of classes", "mask.png", save("voc_segmentation", "SegmentationClass/"))
    c.write("mask", "VOC's segmentation of objects", "mask.png", save("voc_segmentation", "SegmentationObject/"))
    c.write("mask", "Cityscapes, labelIds", "mask.png", save("cityscapes", "labelIds"))
    c.write("mask", "CVAT's XML", "mask.xml", save("cvat", ".xml"), refused="UNSUPPORTED_FORMAT")
    c.write("mask", "Datumaro's own JSON", "mask.json", save("datumaro", "annotations/"))
    c.write("mask", "CamVid", "mask.png", save("camvid", "annot/"))
    c.write("mask", "KITTI's instances", "mask.png", save("kitti_segmentation", "instance/"))
    c.write("mask", "MOTS's PNG", "mask.png", save("mots_png", "instances/"))


@program("Supervisely", distribution="supervisely")
def supervisely_(c, t):
    import supervisely as sly

    def save(path):
        kind = sly.ObjClass("body", sly.Bitmap)
        label = sly.Label(sly.Bitmap(t.mask.astype(bool)), kind)
        dump(sly.Annotation((t.height, t.width), [label]).to_json())(path)

    c.write("mask", "Bitmap", "mask.json", save)

    def polygon(path):
        exterior = [(20, 30), (60, 130), (110, 40)]
        drawn = np.zeros((t.height, t.width), np.uint8)
        shape = sly.Polygon([sly.PointLocation(*each) for each in exterior], [])
        label = sly.Label(shape, sly.ObjClass("body", sly.Polygon))
        label.draw(canvas := np.zeros((t.height, t.width, 3), np.uint8), color=[255, 255, 255])
        drawn[canvas[..., 0] > 0] = 1
        np.save(path.replace("mask.json", "expected.npy"), drawn)
        dump(sly.Annotation((t.height, t.width), [label]).to_json())(path)

    c.write("mask", "Polygon, against its own drawing", "mask.json", polygon, against="expected.npy", limitPixels=320)
