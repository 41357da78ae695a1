"""Loads exported scenes into simulators, and prints a line of JSON for each: `python -m simulators SECONDS FOLDER...`.

A folder holds `mjcf/scene.xml`, `urdf/` and `scene.usda`; what is missing is left out. After SECONDS of physics, each body
has its state: whether it is fixed, how far its centre of mass has moved (metres) and how far it has turned (degrees). In
MuJoCo, a body also has how far it is from where it was found, as exported and after SECONDS: its rotation (degrees) and the
farthest point of its surface (millimetres).
"""

import importlib.util
import json
import os
import sys

import numpy as np


def turned(before, after):
    """The angle between quaternions, degrees; the order of the parts does not matter."""
    cosine = abs(np.dot(before, after)) / (np.linalg.norm(before) * np.linalg.norm(after))
    return float(np.degrees(2 * np.arccos(min(1.0, cosine))))


def rotation_of(wxyz):
    w, x, y, z = np.asarray(wxyz) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def surface_of(path):
    """The vertices of a mesh, in the frame of its body, metres."""
    with open(path) as file:
        return np.array([line.split()[1:4] for line in file if line.startswith("v ")], float)


def farther(surface, found, pose):
    """From a pose (position, quaternion) to another: the rotation, degrees, and the motion of the farthest point, mm."""
    place = lambda position, quaternion: surface @ rotation_of(quaternion).T + position
    farthest = np.linalg.norm(place(*pose) - place(*found), axis=1).max()
    return [turned(found[1], pose[1]), 1000 * float(farthest)]


def in_mujoco(path, seconds):
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    before = (data.xipos.copy(), data.xquat.copy())
    start = list(zip(data.xpos.copy(), data.xquat.copy()))
    while data.time < seconds:
        mujoco.mj_step(model, data)
    bodies = []
    for i in range(1, model.nbody):
        name = model.body(i).name
        found = model.numeric(f"{name}_found").data
        surface = surface_of(os.path.join(os.path.dirname(path), "meshes", f"{name}.obj"))
        geoms = [g for g in range(model.ngeom) if model.geom_bodyid[g] == i and model.geom_contype[g] != 0]
        bodies.append(
            {
                "name": name,
                "fixed": int(model.body_dofnum[i]) == 0,
                "mass": float(model.body_mass[i]),
                "parts": len(geoms),
                "movedM": float(np.linalg.norm(data.xipos[i] - before[0][i])),
                "turnedDeg": turned(before[1][i], data.xquat[i]),
                "exported": farther(surface, (found[:3], found[3:]), start[i]),
                "after": farther(surface, (found[:3], found[3:]), (data.xpos[i], data.xquat[i])),
            }
        )
    cameras = [
        {
            "position": data.cam_xpos[i].tolist(),
            "axes": data.cam_xmat[i].tolist(),
            "window": window_of(model, data, i),
        }
        for i in range(model.ncam)
    ]
    planes = int(np.sum(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE))
    return {"bodies": bodies, "cameras": cameras, "planes": planes}


def window_of(model, data, camera):
    """Left, right, bottom and top of what a camera sees at a distance of 1."""
    import mujoco

    scene = mujoco.MjvScene(model, 1000)
    view = mujoco.MjvCamera()
    view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, camera
    every = mujoco.mjtCatBit.mjCAT_ALL
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), mujoco.MjvPerturb(), view, every, scene)
    seen = scene.camera[0]
    center, half = seen.frustum_center, seen.frustum_width
    sides = [center - half, center + half, seen.frustum_bottom, seen.frustum_top]
    return [float(side / seen.frustum_near) for side in sides]


def in_pybullet(folder, seconds):
    import pybullet

    spec = importlib.util.spec_from_file_location("load", os.path.join(folder, "load.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        ids = module.load(client)
        state = lambda i: tuple(np.array(x) for x in pybullet.getBasePositionAndOrientation(i, physicsClientId=client))
        before = {name: state(i) for name, i in ids.items()}
        loaded = {name: module.pose(client, i) for name, i in ids.items()}
        for _ in range(int(round(240 * seconds))):
            pybullet.stepSimulation(physicsClientId=client)
        bodies = []
        for name, i in ids.items():
            if name == "ground":
                continue
            after = state(i)
            mass = pybullet.getDynamicsInfo(i, -1, physicsClientId=client)[0]
            bodies.append(
                {
                    "name": name,
                    "fixed": mass == 0,
                    "position": list(loaded[name][0]),
                    "mass": mass,
                    "parts": len(pybullet.getCollisionShapeData(i, -1, physicsClientId=client)),
                    "movedM": float(np.linalg.norm(after[0] - before[name][0])),
                    "turnedDeg": turned(before[name][1], after[1]),
                }
            )
        return {"bodies": bodies, "ground": "ground" in ids}
    finally:
        pybullet.disconnect(client)


def in_usd(path):
    from pxr import Usd, UsdGeom, UsdPhysics, UsdValidation

    stage = Usd.Stage.Open(path)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    complaints = UsdValidation.ValidationContext(validators).Validate(stage)
    bodies = []
    cache = UsdGeom.XformCache()
    for prim in stage.GetDefaultPrim().GetChildren():
        if prim.GetTypeName() != "Xform":
            continue
        colliders = [p for p in prim.GetChildren() if p.HasAPI(UsdPhysics.CollisionAPI)]
        is_free = prim.HasAPI(UsdPhysics.RigidBodyAPI)
        mass = UsdPhysics.MassAPI(prim)
        bodies.append(
            {
                "name": prim.GetName(),
                "fixed": not is_free,
                "mass": mass.GetMassAttr().Get() if is_free else None,
                "centerOfMass": list(mass.GetCenterOfMassAttr().Get()) if is_free else None,
                "parts": len(colliders),
                "position": list(cache.GetLocalToWorldTransform(prim).ExtractTranslation()),
            }
        )
    windows = []
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Camera):
            window = UsdGeom.Camera(prim).GetCamera().frustum.window
            windows.append([window.min[0], window.max[0], window.min[1], window.max[1]])
    return {
        "bodies": bodies,
        "upAxis": str(UsdGeom.GetStageUpAxis(stage)),
        "metresPerUnit": UsdGeom.GetStageMetersPerUnit(stage),
        "windows": windows,
        "scenes": sum(1 for p in stage.Traverse() if p.IsA(UsdPhysics.Scene)),
        "complaints": [complaint.GetMessage() for complaint in complaints],
    }


def main():
    seconds = float(sys.argv[1])
    for folder in sys.argv[2:]:
        result = {"folder": folder}
        for name, path, run in [
            ("mujoco", os.path.join(folder, "mjcf", "scene.xml"), lambda p: in_mujoco(p, seconds)),
            ("pybullet", os.path.join(folder, "urdf"), lambda p: in_pybullet(p, seconds)),
            ("usd", os.path.join(folder, "scene.usda"), in_usd),
        ]:
            if os.path.exists(path):
                result[name] = run(path)
        print(json.dumps(result), flush=True)


main()
