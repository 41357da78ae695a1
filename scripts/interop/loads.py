"""Programs that load what we write (`ours.mjs`), and how far what they loaded is from the truth: metres, unless said otherwise."""

import json
import os
import re

import numpy as np

from .cells import farthest, program, rotation

# OpenCV's axes from OpenGL's.
FLIP = np.diag([1.0, -1, -1, 1])
# Floats of 32 bits, and numbers of 7 digits, at half a metre.
LIMIT = 1e-6


def placed(t):
    """The body's points where the camera sees them."""
    return apply(t.matrix(), t.points)


def apply(matrix, points):
    return np.asarray(points, float) @ matrix[:3, :3].T + matrix[:3, 3]


def pose(position, xyzw):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation(xyzw), position
    return matrix


def read(*path):
    with open(os.path.join(*path)) as file:
        return json.load(file)


def obj(path):
    with open(path) as file:
        return np.array([line.split()[1:4] for line in file if line.startswith("v ")], float)


class Scene:
    """The exported scene of one body: what the files should say."""

    def __init__(self, folder):
        self.folder = folder
        self.body = read(folder, "scene.json")
        camera = self.body["camera"]
        self.world_from_camera = pose(camera["position"], camera["rotation"])
        self.world_from_body = pose(self.body["position"], self.body["rotation"])
        self.mass, self.moments = self.body["mass"], np.sort(self.body["principalMoments"])
        self.center = apply(self.world_from_body, [self.body["centerOfMass"]])[0]

    def bodies(self):
        return [(each, os.path.join(self.folder, "urdf", each["file"])) for each in read(self.folder, "urdf", "scene.json")["bodies"]]


def gltf_cells(c, t, ours, load):
    """GLB files by `load(path)`, which returns the vertices in the world of the file."""
    in_opengl = apply(FLIP, placed(t))
    for name in ("node", "baked", "textured", "scene-camera"):
        c.measure("GLB", f"{name}.glb", lambda: farthest(load(os.path.join(ours, f"{name}.glb")), in_opengl), LIMIT)
    path = os.path.join(ours, "node-opencv.glb")
    c.measure("GLB", "node-opencv.glb", lambda: farthest(load(path), placed(t)), LIMIT)
    # With a support, the world is the scene's with y up; z up in the files for simulators.
    scene = Scene(os.path.join(ours, "found"))
    world = apply(scene.world_from_camera, placed(t))
    upright = np.c_[world[:, 0], world[:, 2], -world[:, 1]]

    def body_in_scene():
        vertices = np.asarray(load(os.path.join(ours, "scene.glb")))
        inside = np.linalg.norm(vertices[:, None] - upright[None], axis=2)
        return inside.min(0).max()

    c.measure("GLB", "scene.glb: the body above y = 0", body_in_scene, LIMIT)


@program("trimesh", "load")
def trimesh_(c, t, ours):
    import trimesh

    def load(path):
        # Its Scene joins the geometry with the transforms of the nodes.
        scene = trimesh.load(path)
        return (scene.to_mesh() if hasattr(scene, "to_mesh") else scene.dump(concatenate=True)).vertices

    gltf_cells(c, t, ours, load)
    c.measure("PLY", "exportPly", lambda: farthest(trimesh.load(os.path.join(ours, "placed.ply")).vertices, placed(t)), LIMIT)


@program("Open3D", "load", distribution="open3d")
def open3d_(c, t, ours):
    import open3d as o3d

    gltf_cells(c, t, ours, lambda path: np.asarray(o3d.io.read_triangle_mesh(path).vertices))
    ply = lambda: np.asarray(o3d.io.read_triangle_mesh(os.path.join(ours, "placed.ply")).vertices)
    c.measure("PLY", "exportPly", lambda: farthest(ply(), placed(t)), LIMIT)
    # Rows, as `toRowMajor` returns them; the extrinsic of a camera.
    matrix = lambda: np.array(read(ours, "poses.json")["opencv"]["rows"]).reshape(4, 4)

    def moved():
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(t.points / 0.25)).transform(matrix())
        return farthest(np.asarray(cloud.points), placed(t))

    c.measure("pose", "toRowMajor with PointCloud.transform", moved, LIMIT)


@program("Blender", "load", distribution="bpy")
def blender_(c, t, ours):
    import bpy
    from mathutils import Matrix, Quaternion

    def load(operator, path, **options):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        folder, name = operator.split(".")
        getattr(getattr(bpy.ops, folder), name)(filepath=path, **options)
        bpy.context.view_layer.update()
        meshes = [each for each in bpy.context.scene.objects if each.type == "MESH" and "ground" not in each.name.lower()]
        return np.array([each.matrix_world @ v.co for each in meshes for v in each.data.vertices])

    # Its import turns y up to z up.
    back = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    gltf_cells(c, t, ours, lambda path: apply(back, load("import_scene.gltf", path)))
    ply = lambda: load("wm.ply_import", os.path.join(ours, "placed.ply"))
    c.measure("PLY", "exportPly", lambda: farthest(ply(), placed(t)), LIMIT)
    scene = Scene(os.path.join(ours, "found"))
    world = apply(scene.world_from_camera, placed(t))

    def usd():
        vertices = load("wm.usd_import", os.path.join(ours, "found", "usd", "scene.usda"))
        return np.linalg.norm(vertices[:, None] - world[None], axis=2).min(0).max()

    c.measure("USD", "surface of the body", usd, LIMIT)

    def camera():
        usd()
        found = next(each for each in bpy.context.scene.objects if each.type == "CAMERA")
        return farthest(apply(FLIP @ np.linalg.inv(np.array(found.matrix_world)), world), placed(t))

    c.measure("USD", "the body seen by its camera", camera, LIMIT)

    def lens():
        usd()
        found = next(each for each in bpy.context.scene.objects if each.type == "CAMERA").data
        return found.lens / found.sensor_width * t.width - t.fx

    c.measure("USD", "focal length, pixels", lens, 1e-3)
    turned = lambda: Quaternion(np.roll(t.quaternion, 1).tolist()).to_matrix()
    c.measure("pose", "quaternion as w, x, y, z", lambda: np.array(turned()) - rotation(t.quaternion), 1e-6)
    opengl = lambda: np.array(read(ours, "poses.json")["opengl"]["matrix"]).reshape(4, 4).T

    def child():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        eye = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
        body = bpy.data.objects.new("body", None)
        for each in (eye, body):
            bpy.context.collection.objects.link(each)
        eye.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, "Y")
        bpy.context.view_layer.update()
        body.matrix_world = eye.matrix_world @ Matrix(opengl().tolist())
        bpy.context.view_layer.update()
        inside = np.array(eye.matrix_world.inverted() @ body.matrix_world)
        return farthest(apply(FLIP @ inside, t.points / 0.25), placed(t))

    c.measure("pose", "toFrame(…, opengl) below the camera", child, 2e-6)


@program("PyMeshLab", "load", distribution="pymeshlab")
def pymeshlab_(c, t, ours):
    import pymeshlab

    def load(path):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(path)
        return np.concatenate([each.transformed_vertex_matrix() for each in meshes])

    gltf_cells(c, t, ours, load)
    c.measure("PLY", "exportPly", lambda: farthest(load(os.path.join(ours, "placed.ply")), placed(t)), LIMIT)


@program("meshio", "load")
def meshio_(c, t, ours):
    import meshio

    c.measure("PLY", "exportPly", lambda: farthest(meshio.read(os.path.join(ours, "placed.ply")).points, placed(t)), LIMIT)
    path = os.path.join(ours, "found", "urdf", "meshes", "body.obj")
    c.measure("URDF", "OBJ of the surface", lambda: farthest(meshio.read(path).points, t.points), LIMIT)


@program("MuJoCo", "load", distribution="mujoco")
def mujoco_(c, t, ours):
    import mujoco

    scene = Scene(os.path.join(ours, "found"))
    world = apply(scene.world_from_camera, placed(t))

    def model(path=os.path.join(ours, "found", "mjcf", "scene.xml")):
        model = mujoco.MjModel.from_xml_path(path)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return model, data

    def surface(model, data, geom):
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        return model.mesh_vert[first : first + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]

    def visual(model, data):
        return next(i for i in range(model.ngeom) if model.geom_group[i] == 2)

    def seen():
        m, d = model()
        eye = np.eye(4)
        eye[:3, :3], eye[:3, 3] = d.cam_xmat[0].reshape(3, 3), d.cam_xpos[0]
        return farthest(apply(FLIP @ np.linalg.inv(eye), surface(m, d, visual(m, d))), placed(t))

    c.measure("MJCF", "surface of the body", lambda: farthest(surface(*(md := model()), visual(*md)), world), LIMIT)
    c.measure("MJCF", "the body seen by its camera", seen, LIMIT)
    c.measure("MJCF", "mass, kg", lambda: model()[0].body_mass[1] - scene.mass, 1e-6)
    c.measure("MJCF", "centre of mass", lambda: model()[1].xipos[1] - scene.center, LIMIT)
    c.measure("MJCF", "moments of inertia, relative", lambda: np.sort(model()[0].body_inertia[1]) / scene.moments - 1, 1e-5)
    quat = lambda: model()[1].xquat[1] - np.roll(scene.body["rotation"], 1)
    c.measure("MJCF", "quaternion w, x, y, z", quat, 1e-6)

    def principal():
        m, _ = model()
        d = mujoco.MjData(m)
        mujoco.mj_forward(m, d)
        view, camera = mujoco.MjvScene(m, 100), mujoco.MjvCamera()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(m, d, mujoco.MjvOption(), mujoco.MjvPerturb(), camera, every, view)
        lens = view.camera[0]
        left, right = lens.frustum_center - lens.frustum_width, lens.frustum_center + lens.frustum_width
        u = -left / (right - left) * t.width - 0.5
        v = lens.frustum_top / (lens.frustum_top - lens.frustum_bottom) * t.height - 0.5
        return [u - t.cx, v - t.cy]

    # Before 3.6 the second number of `principalpixel` had the other sign.
    if tuple(map(int, c.version.split(".")[:2])) >= (3, 6):
        c.measure("MJCF", "principal point, pixels", principal, 1e-3)

    def rests():
        m, d = model(os.path.join(ours, "rest", "mjcf", "scene.xml"))
        before = d.xpos[1].copy()
        while d.time < 1:
            mujoco.mj_step(m, d)
        return np.linalg.norm(d.xpos[1] - before)

    c.measure("MJCF", "moved in a second of physics", rests, 0.005)
    # One link is welded to the world, and only its collisions are kept.
    parts = lambda: model(os.path.join(ours, "found", "urdf", "body.urdf"))[0].ngeom - scene.body["parts"]
    c.measure("URDF", "number of parts", parts, 0)


@program("PyBullet", "load", distribution="pybullet")
def pybullet_(c, t, ours):
    import pybullet

    scene = Scene(os.path.join(ours, "found"))
    client = pybullet.connect(pybullet.DIRECT)
    ids = {}
    for each, path in scene.bodies():
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        ids[each["name"]] = pybullet.loadURDF(path, each["position"], each["quaternion"], useFixedBase=each["fixed"], flags=flags)
    body = ids["body"]

    def link():
        position, quaternion = pybullet.getBasePositionAndOrientation(body)
        local = pybullet.getDynamicsInfo(body, -1)[3:5]
        return pose(position, quaternion) @ np.linalg.inv(pose(*local))

    c.measure("URDF", "pose of the link, matrix", lambda: link() - scene.world_from_body, 1e-5)
    c.measure("URDF", "mass, kg", lambda: pybullet.getDynamicsInfo(body, -1)[0] - scene.mass, 1e-6)
    c.measure("URDF", "centre of mass", lambda: pybullet.getBasePositionAndOrientation(body)[0] - scene.center, 1e-5)
    c.measure("URDF", "moments of inertia, relative", lambda: np.sort(pybullet.getDynamicsInfo(body, -1)[2]) / scene.moments - 1, 1e-3)

    def rests():
        before = np.array(pybullet.getBasePositionAndOrientation(body)[0])
        pybullet.setGravity(0, 0, -9.81)
        for _ in range(240):
            pybullet.stepSimulation()
        return np.linalg.norm(before - pybullet.getBasePositionAndOrientation(body)[0])

    c.measure("URDF", "moved in a second of physics", rests, 0.005)
    matrix = lambda: np.array(pybullet.getMatrixFromQuaternion(t.quaternion.tolist())).reshape(3, 3)
    c.measure("pose", "quaternion as x, y, z, w", lambda: matrix() - rotation(t.quaternion), 1e-6)
    pybullet.disconnect(client)


@program("yourdfpy", "load")
def yourdfpy_(c, t, ours):
    import yourdfpy

    scene = Scene(os.path.join(ours, "found"))
    path = os.path.join(ours, "found", "urdf", "body.urdf")
    load = lambda: yourdfpy.URDF.load(path)
    c.measure("URDF", "surface", lambda: farthest(load().scene.to_mesh().vertices, t.points), LIMIT)
    c.measure("URDF", "mass, kg", lambda: load().link_map["body"].inertial.mass - scene.mass, 1e-6)
    c.measure("URDF", "faults found by validate()", lambda: 0 if load().validate() else 1, 0)


@program("usd-core", "load")
def usd_(c, t, ours):
    from pxr import Gf, Usd, UsdGeom, UsdPhysics

    scene = Scene(os.path.join(ours, "found"))
    world = apply(scene.world_from_camera, placed(t))
    stage = Usd.Stage.Open(os.path.join(ours, "found", "usd", "scene.usda"))

    def first(kind, named=""):
        return next(prim for prim in stage.Traverse() if prim.IsA(kind) and named in str(prim.GetPath()))

    def matrix(prim):
        return np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim)).T

    def surface():
        visible = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh) and "body" in str(prim.GetPath())]
        purposes = [prim for prim in visible if UsdGeom.Imageable(prim).ComputePurpose() != "guide"]
        points = [apply(matrix(prim), np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get())) for prim in purposes]
        return np.concatenate(points)

    def seen():
        return farthest(apply(FLIP @ np.linalg.inv(matrix(first(UsdGeom.Camera))), surface()), placed(t))

    def lens():
        camera = UsdGeom.Camera(first(UsdGeom.Camera)).GetCamera(Usd.TimeCode.Default())
        window = camera.frustum.GetWindow()
        near = 1.0
        fx = t.width * near / (window.GetMax()[0] - window.GetMin()[0])
        fy = t.height * near / (window.GetMax()[1] - window.GetMin()[1])
        return [fx - t.fx, fy - t.fy, -window.GetMin()[0] * fx - 0.5 - t.cx, window.GetMax()[1] * fy - 0.5 - t.cy]

    body = lambda: next(prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.MassAPI))
    c.measure("USD", "surface of the body", lambda: farthest(surface(), world), LIMIT)
    c.measure("USD", "the body seen by its camera", seen, LIMIT)
    c.measure("USD", "focal lengths and principal point, pixels", lens, 1e-3)
    c.measure("USD", "mass, kg", lambda: UsdPhysics.MassAPI(body()).GetMassAttr().Get() - scene.mass, 1e-6)
    unit = lambda: [UsdGeom.GetStageMetersPerUnit(stage) - 1, 0 if UsdGeom.GetStageUpAxis(stage) == "Z" else 1]
    c.measure("USD", "metres, z up", unit, 0)
    turned = lambda: np.array(Gf.Matrix3d(Gf.Quatd(float(t.quaternion[3]), *map(float, t.quaternion[:3])))).T
    c.measure("pose", "quaternion as w, x, y, z", lambda: turned() - rotation(t.quaternion), 1e-6)


@program("Newton", "load", distribution="newton")
def newton_(c, t, ours):
    import newton
    import warp

    scene = Scene(os.path.join(ours, "found"))

    def model(load):
        builder = newton.ModelBuilder()
        load(builder)
        return builder

    forms = {
        "MJCF": lambda b: b.add_mjcf(os.path.join(ours, "found", "mjcf", "scene.xml")),
        "USD": lambda b: b.add_usd(os.path.join(ours, "found", "usd", "scene.usda")),
        "URDF": lambda b: b.add_urdf(
            os.path.join(ours, "found", "urdf", "body.urdf"),
            xform=warp.transform(scene.body["position"], scene.body["rotation"]),
            floating=True,
        ),
    }
    for form, load in forms.items():
        built = None

        def builder():
            nonlocal built
            built = built or model(load)
            return built

        def place():
            # Of a URDF, the pose is that of its free joint.
            found = np.array(builder().joint_q[:7] if form == "URDF" else builder().body_q[0], float)
            return pose(found[:3], found[3:]) - scene.world_from_body

        c.measure(form, "pose of the body, matrix", place, 1e-5)
        c.measure(form, "mass, kg", lambda: sum(builder().body_mass) - scene.mass, 1e-5)


@program("Drake", "load", distribution="drake")
def drake_(c, t, ours):
    from pydrake.all import AddMultibodyPlantSceneGraph, DiagramBuilder, Parser, RigidTransform

    scene = Scene(os.path.join(ours, "found"))

    def plant(path):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, 0.001)
        Parser(plant).AddModels(path)
        plant.Finalize()
        builder.Build()
        return plant, plant.CreateDefaultContext()

    def state(path, place=False):
        made, context = plant(path)
        body = made.GetBodyByName("body")
        if place:
            made.SetFreeBodyPose(context, body, RigidTransform(scene.world_from_body))
        return made, context, body

    for form, path in (("MJCF", ("mjcf", "scene.xml")), ("URDF", ("urdf", "body.urdf"))):
        full = os.path.join(ours, "found", *path)

        def place():
            made, context, body = state(full, form == "URDF")
            return made.EvalBodyPoseInWorld(context, body).GetAsMatrix4() - scene.world_from_body

        def mass():
            made, context, body = state(full)
            return body.get_mass(context) - scene.mass

        c.measure(form, "pose of the body, matrix", place, 1e-5)
        c.measure(form, "mass, kg", mass, 1e-5)


@program("SAPIEN", "load", distribution="sapien")
def sapien_(c, t, ours):
    import sapien

    scene = Scene(os.path.join(ours, "found"))

    def body():
        world = sapien.Scene([sapien.physx.PhysxCpuSystem()])
        loader = world.create_urdf_loader()
        # Its visuals need a graphics card.
        with open(os.path.join(ours, "found", "urdf", "body.urdf")) as file:
            text = re.sub("<visual>.*?</visual>", "", file.read())
        bare = os.path.join(ours, "found", "urdf", "body-bare.urdf")
        with open(bare, "w") as file:
            file.write(text)
        # One link is an actor, which `load` refuses.
        _, [actor] = loader.load_multiple(bare)
        x, y, z, w = scene.body["rotation"]
        actor.set_pose(sapien.Pose(scene.body["position"], [w, x, y, z]))
        return actor, actor.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)

    c.measure("URDF", "pose of the link, matrix", lambda: body()[0].pose.to_transformation_matrix() - scene.world_from_body, 1e-5)
    c.measure("URDF", "mass, kg", lambda: body()[1].mass - scene.mass, 1e-5)
    c.measure("URDF", "centre of mass", lambda: np.array(body()[1].cmass_local_pose.p) - scene.body["centerOfMass"], 1e-5)


@program("pycocotools", "load")
def pycocotools_(c, t, ours):
    import contextlib
    import io

    from pycocotools import mask
    from pycocotools.coco import COCO

    count = lambda decoded: int((decoded != t.mask).sum())
    c.measure("mask", "decode of toCocoRle, pixels", lambda: count(mask.decode(read(ours, "mask.json"))), 0)

    def annotation(name):
        with contextlib.redirect_stdout(io.StringIO()):
            coco = COCO(os.path.join(ours, name))
        return count(coco.annToMask(coco.loadAnns([1])[0]))

    c.measure("mask", "annotation, compressed, pixels", lambda: annotation("coco.json"), 0)
    c.measure("mask", "crowd, runs as numbers, pixels", lambda: annotation("coco-crowd.json"), 0)
    same = lambda: 0 if mask.encode(np.asfortranarray(t.mask))["counts"].decode() == read(ours, "mask.json")["counts"] else 1
    c.measure("mask", "the same letters as encode", same, 0)


@program("Datumaro", "load", distribution="datumaro")
def datumaro_(c, t, ours):
    import shutil
    import tempfile

    import datumaro as dm

    def load(name):
        with tempfile.TemporaryDirectory() as folder:
            for each in ("annotations", "images"):
                os.makedirs(os.path.join(folder, each))
            shutil.copy(os.path.join(ours, name), os.path.join(folder, "annotations", "instances_train.json"))
            dataset = dm.Dataset.import_from(folder, "coco_instances")
            [item] = list(dataset)
            return int((item.annotations[0].image.astype(bool) != t.mask.astype(bool)).sum())

    c.measure("mask", "COCO, compressed, pixels", lambda: load("coco.json"), 0)
    c.measure("mask", "COCO, crowd, pixels", lambda: load("coco-crowd.json"), 0)


@program("CVAT", "load", distribution="cvat-sdk")
def cvat_(c, t, ours):
    from cvat_sdk import masks, models

    def shape():
        points = read(ours, "cuboid.json")["points"]
        made = models.LabeledShapeRequest(type="cuboid", frame=0, label_id=1, points=points)
        return np.array(made.to_dict()["points"])

    def corners():
        # CVAT draws with three.js: a box of this size, turned by Euler angles x, y, z of its default order.
        x, y, z, rx, ry, rz, sx, sy, sz = shape()[:9]
        turn = lambda axis, a: rotation(np.r_[np.sin(a / 2) * np.eye(3)[axis], np.cos(a / 2)])
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) / 2
        box = signs * [sx, sy, sz] @ (turn(0, rx) @ turn(1, ry) @ turn(2, rz)).T + [x, y, z]
        to_camera = np.array(read(ours, "cuboid.json")["toCamera"]).reshape(4, 4).T
        return farthest(apply(to_camera, box), np.array(read(ours, "cuboid.json")["corners"]).reshape(-1, 3))

    c.measure("cuboid", "points of a shape", corners, LIMIT)


@program("SciPy", "load", distribution="scipy")
def scipy_(c, t, ours):
    from scipy.spatial.transform import Rotation

    turned = lambda: Rotation.from_quat(read(ours, "poses.json")["opencv"]["rotation"]).as_matrix() - rotation(t.quaternion)
    c.measure("pose", "from_quat", turned, 1e-9)

    def cuboid():
        points = read(ours, "cuboid.json")["points"]
        quaternion = read(ours, "cuboid.json")["cuboid"]["quaternion"]
        return (Rotation.from_euler("XYZ", points[3:6]).inv() * Rotation.from_quat(quaternion)).magnitude()

    c.measure("cuboid", "from_euler XYZ of CVAT's points, radians", cuboid, 1e-9)


@program("pycolmap", "load")
def pycolmap_(c, t, ours):
    import pycolmap

    def moved():
        given = read(ours, "poses.json")["opencv"]
        similar = pycolmap.Sim3d(given["scale"], pycolmap.Rotation3d(np.array(given["rotation"])), np.array(given["translation"]))
        return farthest(np.array([similar * each for each in t.points / 0.25]), placed(t))

    c.measure("pose", "Sim3d of x, y, z, w", moved, LIMIT)


@program("NumPy", "load", distribution="numpy")
def numpy_(c, t, ours):
    def bop():
        entry = read(ours, "scene_gt.json")["0"][0]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"]) / 1000
        return farthest(apply(matrix, t.points), placed(t))

    c.measure("BOP", "scene_gt.json, rows and millimetres", bop, LIMIT)
    frames = {"opencv": np.eye(4), "opengl": FLIP, "pytorch3d": np.diag([-1.0, -1, 1, 1])}
    frames["ros"] = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    for frame, to_camera in frames.items():
        given = lambda: read(ours, "poses.json")[frame]
        rows = lambda: farthest(apply(to_camera @ np.reshape(given()["rows"], (4, 4)), t.points / 0.25), placed(t))
        columns = lambda: np.reshape(given()["matrix"], (4, 4)).T - np.reshape(given()["rows"], (4, 4))
        c.measure("pose", f"{frame}: rows", rows, LIMIT)
        c.measure("pose", f"{frame}: columns are its transpose", columns, 0)


@program("plyfile", "load")
def plyfile_(c, t, ours):
    from plyfile import PlyData

    def splats():
        source, ply = read(ours, "splats.json"), PlyData.read(os.path.join(ours, "splats.ply"))["vertex"]
        before = PlyData.read(source["source"])["vertex"]
        xyz = lambda rows: np.c_[rows["x"], rows["y"], rows["z"]]
        matrix = t.matrix()
        matrix[:3, :3] *= source["scale"]
        grown = [ply[f"scale_{k}"] - before[f"scale_{k}"] - np.log(source["scale"]) for k in range(3)]
        return max(np.abs(apply(matrix, xyz(before)) - xyz(ply)).max(), np.abs(grown).max())

    c.measure("splats", "places, and logarithms of sizes", splats, 2e-6)
