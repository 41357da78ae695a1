"""The kitchen: a table in the light of a window, what stands in the background, and the camera."""

from math import radians

import bpy
import numpy as np
from mathutils import Vector

from . import prints, shapes

SIZE = (640, 480)
# A lens of 25 mm on a sensor of Four Thirds, 17.3 mm wide.
LENS_MM, SENSOR_MM, STOP = 25, 17.3, 3.5
FOCAL_PX = SIZE[0] * LENS_MM / SENSOR_MM
EYE, LOOKS_AT = Vector((-0.05, -0.53, 0.285)), Vector((0.012, -0.005, 0.04))


def _nodes(name, roughness):
    made = prints.material(name, roughness=roughness)
    tree = made.node_tree
    return made, tree.nodes, tree.links.new, tree.nodes["Principled BSDF"]


def _ramp(nodes, *stops):
    ramp = nodes.new("ShaderNodeValToRGB")
    for k, (position, colour) in enumerate(stops):
        element = ramp.color_ramp.elements[k] if k < 2 else ramp.color_ramp.elements.new(position)
        element.position, element.color = position, (*colour, 1)
    return ramp


def _wood(name, dark, light, stretch, roughness=0.42):
    """Boards: a grain that is long in one direction."""
    made, nodes, link, shader = _nodes(name, roughness)
    place, scaled, grain = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexNoise")
    scaled.inputs["Scale"].default_value = stretch
    grain.inputs["Scale"].default_value, grain.inputs["Detail"].default_value = 1.0, 8
    grain.inputs["Distortion"].default_value = 0.6
    ramp = _ramp(nodes, (0.3, dark), (0.72, light))
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.15, 0.002
    link(place.outputs["Object"], scaled.inputs["Vector"])
    link(scaled.outputs["Vector"], grain.inputs["Vector"])
    link(grain.outputs[0], ramp.inputs["Fac"])
    link(ramp.outputs["Color"], shader.inputs["Base Color"])
    link(grain.outputs[0], bump.inputs["Height"])
    link(bump.outputs["Normal"], shader.inputs["Normal"])
    return made


def _tiles(name):
    made, nodes, link, shader = _nodes(name, 0.15)
    place, tiles, bump = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeTexBrick"), nodes.new("ShaderNodeBump")
    turned = nodes.new("ShaderNodeMapping")
    turned.inputs["Rotation"].default_value = (radians(90), 0, 0)
    for slot, colour in (("Color1", (0.72, 0.78, 0.74)), ("Color2", (0.66, 0.74, 0.70)), ("Mortar", (0.5, 0.48, 0.45))):
        tiles.inputs[slot].default_value = (*colour, 1)
    sizes = {"Scale": 1, "Mortar Size": 0.0025, "Brick Width": 0.15, "Row Height": 0.075}
    for slot, value in sizes.items():
        tiles.inputs[slot].default_value = value
    bump.inputs["Strength"].default_value, bump.invert = 0.4, True
    link(place.outputs["Object"], turned.inputs["Vector"])
    link(turned.outputs["Vector"], tiles.inputs["Vector"])
    link(tiles.outputs["Color"], shader.inputs["Base Color"])
    link(tiles.outputs["Fac"], bump.inputs["Height"])
    link(bump.outputs["Normal"], shader.inputs["Normal"])
    return made


def _slab(name, low, high, material):
    """A box between two corners."""
    low, high = np.array(low), np.array(high)
    thing = shapes.box(name, high - low, material=material)
    thing.location = (*((low + high) / 2)[:2], low[2])
    return thing


def furnish():
    wood = _wood("oak", (0.20, 0.10, 0.045), (0.47, 0.29, 0.15), (3, 40, 40))
    white = prints.material("wall", (0.75, 0.73, 0.68), roughness=0.8)
    for k in range(5):
        board = _slab(f"board {k}", (-1.0, -0.65 + 0.24 * k, -0.03), (1.0, -0.4125 + 0.24 * k, 0), wood)
        board.data.transform(board.matrix_world.Translation((0.37 * k, 0, 0)))
        board.location.x -= 0.37 * k
    _slab("tiles", (-1.6, 0.56, -0.5), (1.6, 0.6, 1.7), _tiles("tiles"))
    # The wall on the left has a window with a cross.
    for k, (low, high) in enumerate((
        ((-1.1, -2.5, -0.5), (-1.0, -0.45, 2.2)), ((-1.1, 0.45, -0.5), (-1.0, 0.6, 2.2)),
        ((-1.1, -0.45, -0.5), (-1.0, 0.45, 0.12)), ((-1.1, -0.45, 1.15), (-1.0, 0.45, 2.2)),
        ((-1.06, -0.02, 0.12), (-1.03, 0.02, 1.15)), ((-1.06, -0.45, 0.62), (-1.03, 0.45, 0.65)),
    )):
        _slab(f"wall {k}", low, high, white)

    board = shapes.box("cutting board", (0.26, 0.018, 0.36), 0.006, _wood("beech", (0.42, 0.25, 0.12), (0.62, 0.42, 0.23), (40, 40, 4)))
    board.location, board.rotation_euler = (0.16, 0.46, 0.0), (radians(-10), 0, radians(-4))
    bowl = shapes.lathe("bowl", [(0.001, 0), (0.045, 0), (0.05, 0.006), (0.09, 0.04), (0.105, 0.07), (0.102, 0.07), (0.086, 0.042), (0.045, 0.012), (0.001, 0.01)], material=prints.material("stoneware", (0.22, 0.30, 0.36), roughness=0.25))
    bowl.location = (-0.30, 0.30, 0)
    peel = prints.material("peel", (0.85, 0.30, 0.02), roughness=0.45)
    for k, (x, y, z) in enumerate(((-0.335, 0.28, 0.062), (-0.265, 0.285, 0.06), (-0.30, 0.345, 0.062), (-0.30, 0.30, 0.115))):
        shapes.ellipsoid(f"orange {k}", (x, y, z), (0.038, 0.038, 0.036), (k, 0.4 * k, 0), peel)


def light():
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (0.75, 0.85, 1, 1), 0.35
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.data.color = 4.5, radians(0.8), (1, 0.86, 0.68)
    sun.rotation_euler = Vector((-1.25, 0.35, 0.85)).to_track_quat("Z", "Y").to_euler()
    sky = bpy.data.objects.new("sky", bpy.data.lights.new("sky", "AREA"))
    sky.data.shape, sky.data.size, sky.data.size_y = "RECTANGLE", 1.0, 0.9
    sky.data.energy, sky.data.color = 26, (0.82, 0.91, 1)
    sky.location, sky.rotation_euler = (-0.98, 0, 0.64), (0, radians(-90), 0)
    for lamp in (sun, sky):
        scene.collection.objects.link(lamp)


def camera():
    scene = bpy.context.scene
    made = bpy.data.cameras.new("camera")
    made.lens, made.sensor_width, made.sensor_fit = LENS_MM, SENSOR_MM, "HORIZONTAL"
    made.dof.aperture_fstop = STOP
    made.dof.focus_distance = (LOOKS_AT - EYE).length - 0.02
    eye = bpy.data.objects.new("camera", made)
    eye.location = EYE
    eye.rotation_euler = (LOOKS_AT - EYE).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(eye)
    scene.camera = eye
    bpy.context.view_layer.update()
    return made


def camera_from_world():
    """To the frame of OpenCV: Blender's cameras look along -z, with y up."""
    inverse = np.array(bpy.context.scene.camera.matrix_world.inverted())
    return np.diag([1, -1, -1, 1]) @ inverse


def _rendered(path, samples, is_photo):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.seed = "CYCLES", "CPU", 1
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *SIZE, 100
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, is_photo, False
    # Facts are those at the middles of pixels.
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 1.5
    if not is_photo:
        scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    scene.camera.data.dof.use_dof = is_photo
    scene.view_settings.view_transform, scene.view_settings.look = "AgX", "AgX - Medium High Contrast"
    scene.view_settings.exposure = 0.45
    scene.render.image_settings.file_format = "PNG" if is_photo else "OPEN_EXR"
    scene.render.image_settings.color_depth = "8" if is_photo else "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def render(path, samples):
    """The photo."""
    bpy.context.view_layer.material_override = None
    _rendered(path, samples, True)


def measured(path):
    """The depth along the axis, in metres, and the index of the object of each pixel, at the middles of the pixels."""
    facts = bpy.data.materials.new("facts")
    facts.use_nodes = True
    nodes, link = facts.node_tree.nodes, facts.node_tree.links.new
    nodes.clear()
    seen, which, both = nodes.new("ShaderNodeCameraData"), nodes.new("ShaderNodeObjectInfo"), nodes.new("ShaderNodeCombineXYZ")
    glow, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    link(seen.outputs["View Z Depth"], both.inputs["X"])
    link(which.outputs["Object Index"], both.inputs["Y"])
    link(both.outputs["Vector"], glow.inputs["Color"])
    link(glow.outputs["Emission"], out.inputs["Surface"])
    bpy.context.view_layer.material_override = facts
    _rendered(path, 1, False)
    pixels = np.empty(4 * SIZE[0] * SIZE[1], np.float32)
    bpy.data.images.load(str(path)).pixels.foreach_get(pixels)
    pixels = pixels.reshape(SIZE[1], SIZE[0], 4)[::-1]
    return pixels[..., 0], np.rint(pixels[..., 1]).astype(int)
