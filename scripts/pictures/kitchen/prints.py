"""What is printed on the objects, as images, and their materials."""

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFont

CREAM, GREEN, GOLD, RED, BLUE = "#f1e8d3", "#1f5a45", "#d9a441", "#b5432f", "#2f6690"


def material(name, colour=None, image=None, roughness=0.5, coat=0.0, subsurface=0.0):
    """A material of a colour (linear) or of an image."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Coat Weight"].default_value = coat
    shader.inputs["Subsurface Weight"].default_value = subsurface
    shader.inputs["Subsurface Scale"].default_value = 0.01
    if colour is not None:
        shader.inputs["Base Color"].default_value = (*colour, 1)
    if image is not None:
        node = made.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = in_blender(name, image)
        made.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return made


def in_blender(name, picture):
    """An image of Blender with these pixels."""
    width, height = picture.size
    image = bpy.data.images.new(name, width, height)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = np.asarray(picture.convert("RGB"), np.float32)[::-1] / 255
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def _text(draw, at, words, size, fill):
    draw.text(at, words, fill, ImageFont.load_default(size), anchor="mm")


def _leaf(draw, x, y, length, angle, fill):
    """A pointed leaf that begins at (x, y)."""
    s = np.linspace(0, 1, 24)
    width = 0.22 * length * np.sin(np.pi * s) ** 0.8
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    middle = np.array([x, y]) + length * s[:, None] * along
    outline = np.concatenate([middle + width[:, None] * across, (middle - width[:, None] * across)[::-1]])
    draw.polygon([tuple(p) for p in outline], fill)


def carton():
    """The six sides of a carton of tea."""
    side = 480
    whole = Image.new("RGB", (3 * side, 2 * side), GREEN)
    for k in range(6):
        tile = Image.new("RGB", (side, side), GREEN)
        draw = ImageDraw.Draw(tile)
        middle = side / 2
        if k in (0, 2):
            draw.rectangle((0, 0, side, 46), GOLD)
            draw.ellipse((50, 100, side - 50, 330), CREAM)
            _text(draw, (middle, 180), "EARL GREY", 56, GREEN)
            _text(draw, (middle, 245), "TEA", 52, RED)
            for turn in (-0.35, -1.1, -2.0, -2.8) if k == 0 else (-0.8, -1.57, -2.3):
                _leaf(draw, middle, 440, 110, turn, GOLD if k == 0 else CREAM)
        elif k in (1, 3):
            draw.rectangle((0, 0, side, 46), GOLD)
            for row in range(5):
                draw.rectangle((70, 110 + 44 * row, side - 70 - 60 * (row % 3), 126 + 44 * row), CREAM)
            _text(draw, (middle, 400), "20 bags" if k == 1 else "40 g", 74, GOLD)
        elif k == 4:
            draw.rectangle((24, 24, side - 24, side - 24), outline=GOLD, width=14)
            _text(draw, (middle, middle), "TEA", 150, CREAM)
        whole.paste(tile, (k % 3 * side, k // 3 * side))
    return whole


def glaze():
    """The outside of a mug, unrolled: below blue with a wavy edge, above cream with a sun."""
    width, height = 1200, 480
    picture = Image.new("RGB", (width, height), CREAM)
    draw = ImageDraw.Draw(picture)
    x = np.arange(width + 1)
    edge = 290 + 22 * np.sin(2 * np.pi * 5 * x / width)
    draw.polygon([*zip(x, edge), (width, height), (0, height)], BLUE)
    draw.line([*zip(x, edge - 26)], GOLD, 9)
    for k, centre in enumerate((150, 450, 750, 1050)):
        if k % 2 == 0:
            _sun(draw, centre, 140)
        else:
            for i in range(9):
                draw.ellipse(_dot(centre, i), RED)
    return picture


def _dot(centre, i):
    x, y = centre + 62 * (i % 3 - 1), 140 + 56 * (i // 3 - 1)
    return (x - 15, y - 15, x + 15, y + 15)


def _sun(draw, x, y):
    for angle in np.arange(12) * np.pi / 6:
        dx, dy = np.cos(angle), np.sin(angle)
        draw.line((x + 62 * dx, y + 62 * dy, x + 96 * dx, y + 96 * dy), RED, 12)
    draw.ellipse((x - 48, y - 48, x + 48, y + 48), GOLD)
