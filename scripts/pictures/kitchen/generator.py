"""Meshes as generators return them: one closed surface of no particular size, in axes of their own, not quite of the right shape."""

import bpy
import numpy as np
from scipy.spatial.transform import Rotation

from . import shapes

# Axes of each mesh, from those of its object: y up; y up, seen from a side; z up.
AXES = {
    "mug": Rotation.from_euler("x", -90, degrees=True),
    "box": Rotation.from_euler("y", 90, degrees=True) * Rotation.from_euler("x", -90, degrees=True),
    "duck": Rotation.from_euler("z", 180, degrees=True),
}
TRIANGLES = {"mug": 2600, "box": 700, "duck": 2200}
TEXTURE = 384


def generated(thing, name, rng):
    """A copy of an object as a generator would return it. Returns it with the positions that its vertices have in the world."""
    copy = thing.copy()
    copy.data, copy.name = thing.data.copy(), f"generated {name}"
    bpy.context.scene.collection.objects.link(copy)
    shapes.modifier(copy, "REMESH", mode="VOXEL", voxel_size=max(thing.dimensions) / 84, use_smooth_shade=True)
    shapes.modifier(copy, "SMOOTH", iterations=2, factor=0.5)
    shapes.modifier(copy, "DECIMATE", ratio=TRIANGLES[name] / (2 * len(copy.data.polygons)))
    shapes.modifier(copy, "TRIANGULATE")
    image = _baked(copy, thing)
    own = _vertices(copy)
    world = own @ np.array(copy.matrix_world)[:3, :3].T + np.array(copy.matrix_world)[:3, 3]
    made = _distorted(own, rng) @ AXES[name].as_matrix().T
    low, high = made.min(axis=0), made.max(axis=0)
    made = (made - (low + high) / 2) / max(high - low)
    copy.data.vertices.foreach_set("co", made.astype(np.float32).ravel())
    copy.matrix_world.identity()
    copy.data.update()
    _shaded(copy, image)
    return copy, made, world


def _vertices(thing):
    values = np.empty(3 * len(thing.data.vertices), np.float32)
    thing.data.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(float)


def _distorted(points, rng):
    """Sides of one or two per cent too much or too little, bulges, and a rough surface."""
    size = np.ptp(points, axis=0).max()
    middle = points.mean(axis=0)
    bulges = np.zeros_like(points)
    for _ in range(10):
        wave = rng.normal(size=3) * 2.2 / size
        bulges += rng.normal(size=3) * np.sin(points @ wave * np.pi + rng.uniform(0, 2 * np.pi))[:, None]
    stretch = 1 + rng.uniform(-0.015, 0.015, 3)
    return middle + (points - middle) * stretch + 0.0022 * size * bulges + rng.normal(size=points.shape) * 0.0006 * size


def _baked(copy, thing):
    """Bakes the colours of an object into a texture of the copy."""
    image = bpy.data.images.new(copy.name, TEXTURE, TEXTURE)
    _shaded(copy, image)
    shapes.chosen(copy)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=0.006)
    bpy.ops.object.mode_set(mode="OBJECT")
    shapes.chosen(thing, copy)
    bpy.context.scene.cycles.samples = 4
    bpy.context.view_layer.material_override = None
    size = max(thing.dimensions)
    bpy.ops.object.bake(
        type="DIFFUSE", pass_filter={"COLOR"}, use_selected_to_active=True, cage_extrusion=0.02 * size,
        max_ray_distance=0.06 * size, margin=6,
    )
    image.pack()
    return image


def _shaded(copy, image):
    made = bpy.data.materials.new(copy.name)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    nodes.active = texture
    shader = nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.6
    made.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    copy.data.materials.clear()
    copy.data.materials.append(made)


def write(copy, path):
    shapes.chosen(copy)
    bpy.ops.export_scene.gltf(
        filepath=path, use_selection=True, export_yup=False, export_normals=False, export_image_format="JPEG",
        export_image_quality=65,
    )


def similarity(source, target):
    """Scale, rotation and translation that bring points closest to others (Umeyama 1991)."""
    a, b = source - source.mean(axis=0), target - target.mean(axis=0)
    u, values, vt = np.linalg.svd(b.T @ a)
    signs = np.array([1, 1, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ np.diag(signs) @ vt
    scale = (values * signs).sum() / (a**2).sum()
    return scale, rotation, target.mean(axis=0) - scale * rotation @ source.mean(axis=0)
