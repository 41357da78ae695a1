"""The three objects: a mug, a carton of tea and a rubber duck. They stand on z = 0, in metres."""

from math import radians

import numpy as np

from . import prints, shapes


def mug():
    outside = prints.material("glaze", image=prints.glaze(), roughness=0.18, coat=0.5)
    inside = prints.material("inside", (0.80, 0.74, 0.62), roughness=0.2, coat=0.5)
    radius, height, wall = 0.041, 0.092, 0.0045
    foot = [(0.001, 0.003), (0.030, 0.003), (0.031, 0), (0.036, 0), (0.0385, 0.004)]
    rise = [(radius - 0.0015 * (1 - t) ** 2, 0.006 + (height - 0.009) * t) for t in np.linspace(0, 1, 14)]
    lip = [(radius - 0.001, height - 0.001), (radius - wall / 2, height), (radius - wall, height - 0.0015)]
    fall = [(radius - wall - 0.0005, z) for z in np.linspace(height - 0.006, 0.016, 8)]
    base = [(radius - wall - 0.003, 0.010), (radius - wall - 0.012, 0.008), (0.001, 0.0075)]
    body = shapes.lathe("body", foot + rise + lip + fall + base, 128, outside)
    body.data.materials.append(inside)
    # Print by height on the outside, glaze in one colour elsewhere.
    layer, first = body.data.uv_layers[0].data, len(foot) + len(rise)
    for face in body.data.polygons:
        rows = [i // 128 for i in face.vertices]
        face.material_index = int(min(rows) >= first)
        for corner, vertex in zip(face.loop_indices, face.vertices):
            layer[corner].uv.y = body.data.vertices[vertex].co.z / height
    turns = np.linspace(-0.5, 0.5, 40) * np.pi * 1.04
    loop = [(radius - 0.003 + 0.031 * np.cos(a), 0, 0.048 + 0.031 * np.sin(a)) for a in turns]
    handle = shapes.tube("handle", loop, (0.0065, 0.0045), material=prints.material("handle", (0.03, 0.13, 0.27), roughness=0.18, coat=0.5))
    return shapes.joined("mug", handle, body)


def carton():
    paper = prints.material("carton", image=prints.carton(), roughness=0.38, coat=0.15)
    return shapes.box("box", (0.078, 0.056, 0.122), 0.0012, paper)


def duck():
    yellow = prints.material("yellow", (0.86, 0.52, 0.02), roughness=0.3, subsurface=0.15)
    orange = prints.material("orange", (0.80, 0.13, 0.01), roughness=0.3)
    black = prints.material("black", (0.01, 0.01, 0.01), roughness=0.1)
    white = prints.material("white", (0.8, 0.8, 0.8), roughness=0.15)
    body = shapes.joined(
        "body",
        shapes.ellipsoid("wing", (-0.006, 0.026, 0.034), (0.024, 0.008, 0.014), (0.2, -0.25, -0.12), yellow),
        shapes.ellipsoid("wing", (-0.006, -0.026, 0.034), (0.024, 0.008, 0.014), (-0.2, -0.25, 0.12), yellow),
        shapes.ellipsoid("tail", (-0.041, 0, 0.044), (0.020, 0.015, 0.008), (0, radians(38), 0), yellow),
        shapes.ellipsoid("breast", (0.016, 0, 0.034), (0.027, 0.027, 0.029), (0, 0, 0), yellow),
        shapes.ellipsoid("neck", (0.018, 0, 0.055), (0.018, 0.018, 0.014), (0, 0, 0), yellow),
        shapes.ellipsoid("head", (0.020, 0, 0.079), (0.0245, 0.0235, 0.0235), (0, 0, 0), yellow),
        shapes.ellipsoid("trunk", (-0.004, 0, 0.027), (0.046, 0.033, 0.027), (0, 0, 0), yellow),
    )
    shapes.modifier(body, "REMESH", mode="VOXEL", voxel_size=0.0014, use_smooth_shade=True)
    shapes.modifier(body, "SMOOTH", iterations=14)
    eyes = [
        shapes.ellipsoid("eye", (0.0375, side * 0.0115, 0.086), (0.0052, 0.0045, 0.006), (0, 0, side * 0.45), white)
        for side in (1, -1)
    ]
    pupils = [
        shapes.ellipsoid("pupil", (0.0413, side * 0.0128, 0.0865), (0.0027, 0.0026, 0.0036), (0, 0, side * 0.45), black)
        for side in (1, -1)
    ]
    beak = shapes.ellipsoid("beak", (0.0455, 0, 0.0755), (0.013, 0.012, 0.0042), (0, radians(-12), 0), orange)
    jaw = shapes.ellipsoid("jaw", (0.043, 0, 0.0705), (0.010, 0.009, 0.003), (0, radians(14), 0), orange)
    duck = shapes.joined("duck", *eyes, *pupils, beak, jaw, body)
    # Flat below, as toys are that stand.
    for vertex in duck.data.vertices:
        vertex.co.z = max(vertex.co.z, 0.004) - 0.004
    return duck


def placed():
    """The objects in their places, with the numbers that the renderer knows them by."""
    places = {"duck": (duck(), (-0.022, -0.075), -52), "mug": (mug(), (0.098, -0.012), 22), "box": (carton(), (-0.072, 0.062), 24)}
    for k, (thing, (x, y), turn) in enumerate(places.values()):
        thing.location, thing.rotation_euler = (x, y, 0), (0, 0, radians(turn))
        thing.pass_index = k + 1
    return {name: thing for name, (thing, *_) in places.items()}
