"""Meshes: surfaces of revolution, tubes, ellipsoids and boxes, as Blender's objects."""

import bpy
import numpy as np


def add(name, vertices, faces, uvs=None, material=None, smooth=True):
    """An object of a mesh; `uvs` has a pair for each corner of each face."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
    if uvs is not None:
        layer = mesh.uv_layers.new(name="UVMap")
        layer.data.foreach_set("uv", np.asarray(uvs, float).ravel())
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    if material is not None:
        mesh.materials.append(material)
    return thing


def _grid(rows, columns, is_tube):
    """Faces of a grid that is closed in its columns, with (u, v) of their corners: u along columns, v along rows."""
    faces, uvs = [], []
    for i in range(rows - 1):
        for j in range(columns):
            k = (j + 1) % columns
            faces.append((i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j))
            low, high = i / (rows - 1), (i + 1) / (rows - 1)
            uvs += [(j / columns, low), ((j + 1) / columns, low), ((j + 1) / columns, high), (j / columns, high)]
    if is_tube:
        return faces, uvs
    for row in (0, rows - 1):
        ring = [row * columns + j for j in range(columns)]
        faces.append(ring[::-1] if row == 0 else ring)
        uvs += [(0, 0)] * columns
    return faces, uvs


def lathe(name, profile, columns=96, material=None):
    """Turns a profile of (radius, height) about z; its ends are closed."""
    turns = 2 * np.pi * np.arange(columns) / columns
    vertices = [(r * np.cos(a), r * np.sin(a), z) for r, z in profile for a in turns]
    return add(name, vertices, *_grid(len(profile), columns, False), material=material)


def tube(name, path, radii, columns=24, material=None):
    """A tube along a path in the plane y = 0, with an elliptic section: across the plane, and in it."""
    path = np.asarray(path, float)
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.stack([along[:, 2], 0 * along[:, 0], -along[:, 0]], axis=1)
    turns = 2 * np.pi * np.arange(columns) / columns
    across, inside = radii
    vertices = [
        p + across * np.cos(a) * np.array([0, 1, 0]) + inside * np.sin(a) * n for p, n in zip(path, out) for a in turns
    ]
    return add(name, vertices, *_grid(len(path), columns, False), material=material)


def ellipsoid(name, centre, radii, turn=(0, 0, 0), material=None):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, location=centre, rotation=turn)
    thing = bpy.context.object
    thing.name, thing.scale = name, radii
    thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
    thing.data.materials.clear()
    thing.data.materials.append(material)
    return thing


def box(name, size, bevel=0.0, material=None):
    """A box that stands on z = 0. Its sides have the parts of an image of 3 × 2: front, right, back; left, top, bottom."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    vertices = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0), (-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)]
    faces = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7), (3, 2, 1, 0)]
    uvs = []
    for k in range(6):
        u, v = (k % 3) / 3, 0.5 - 0.5 * (k // 3)
        uvs += [(u, v), (u + 1 / 3, v), (u + 1 / 3, v + 0.5), (u, v + 0.5)]
    thing = add(name, vertices, faces, uvs, material, smooth=False)
    if bevel > 0:
        modifier(thing, "BEVEL", width=bevel, segments=3)
    return thing


def modifier(thing, kind, **settings):
    """Applies a modifier."""
    one = thing.modifiers.new(kind, kind)
    for name, value in settings.items():
        setattr(one, name, value)
    chosen(thing)
    bpy.ops.object.modifier_apply(modifier=one.name)


def chosen(*things):
    """Selects objects; the last one is active."""
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[-1]


def joined(name, *things):
    """One object of several, in the axes of the last one."""
    for thing in things:
        chosen(thing)
        bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    chosen(*things)
    bpy.ops.object.join()
    things[-1].name = name
    return things[-1]
