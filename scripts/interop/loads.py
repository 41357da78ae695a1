"""Simulators and renderers, and readers of their files: they load our scenes."""

import re
from pathlib import Path

import numpy as np

from .cells import FLIP, MM, Scene, apply, program, rigid, rotation


@program("MuJoCo")
def mujoco_(c, t):
    import mujoco

    # Depth of MuJoCo's renderer needs a display; what it writes itself is the meshes of a model.
    def save(path):
        spec = mujoco.MjSpec()
        spec.add_mesh(name="body", uservert=t.points.ravel(), userface=t.triangles.ravel())
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="body")
        model = spec.compile()
        # A compiled mesh lies in the frame of its inertia.
        vertices = apply(rigid(np.roll(model.mesh_quat[0], -1), model.mesh_pos[0]), model.mesh_vert)
        with open(path, "w") as file:
            np.savetxt(file, vertices, "v %.9g %.9g %.9g")
            np.savetxt(file, model.mesh_face + 1, "f %d %d %d")

    c.write("mesh", "mesh_vert with mesh_pos and mesh_quat", "mesh.obj", {"limitM": 1e-6}, save)

    def load(*path):
        model = mujoco.MjModel.from_xml_path(t.ours(*path))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return model, data

    scene = Scene(t)
    model, data = load("found", "mjcf", "scene.xml")
    visual = list(model.geom_group).index(2)
    first, count = model.mesh_vertadr[model.geom_dataid[visual]], model.mesh_vertnum[model.geom_dataid[visual]]
    frame = rigid(data.geom_xmat[visual].reshape(3, 3), data.geom_xpos[visual])
    surface = apply(frame, model.mesh_vert[first : first + count])
    eye = rigid(data.cam_xmat[0].reshape(3, 3), data.cam_xpos[0])
    c.points("MJCF", "surface of the body", surface, scene.points)
    c.points("MJCF", "the body seen by its camera", apply(FLIP @ np.linalg.inv(eye), surface), t.placed)
    c.measure("MJCF", "mass, kg", model.body_mass[1] - scene.mass)
    c.measure("MJCF", "centre of mass", data.xipos[1] - scene.center)
    c.measure("MJCF", "moments of inertia, relative", np.sort(model.body_inertia[1]) / scene.moments - 1, 1e-5)
    c.measure("MJCF", "quaternion w, x, y, z", data.xquat[1] - np.roll(scene.body["rotation"], 1))

    # Before 3.6 the second number of `principalpixel` had the other sign.
    if not c.version.startswith("3.3"):
        view, camera = mujoco.MjvScene(model, 100), mujoco.MjvCamera()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
        how = mujoco.MjvOption(), mujoco.MjvPerturb(), camera, mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, *how, view)
        lens = view.camera[0]
        u = (lens.frustum_width - lens.frustum_center) / (2 * lens.frustum_width) * t.width - 0.5
        v = lens.frustum_top / (lens.frustum_top - lens.frustum_bottom) * t.height - 0.5
        c.measure("MJCF", "principal point, pixels", [u - t.cx, v - t.cy], 1e-3)

    model, data = load("rest", "mjcf", "scene.xml")
    before = data.xpos[1].copy()
    while data.time < 1:
        mujoco.mj_step(model, data)
    c.measure("MJCF", "moved in a second of physics", np.linalg.norm(data.xpos[1] - before), 0.005)
    # One link is welded to the world, and only its collisions are kept.
    model, _ = load("found", "urdf", "body.urdf")
    c.measure("URDF", "number of parts", model.ngeom - scene.body["parts"], 0)


@program("PyBullet")
def pybullet_(c, t):
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    near, far = 0.05, 5.0
    vertices, indices = t.points.tolist(), t.triangles.ravel().tolist()
    visual = pybullet.createVisualShape(pybullet.GEOM_MESH, vertices=vertices, indices=indices)
    pybullet.createMultiBody(0, -1, visual)
    # OpenGL's camera looks along -z. The software renderer looks through the lower left corner of each pixel.
    view = FLIP @ t.matrix
    lens = np.zeros((4, 4))
    lens[0, 0], lens[0, 2] = 2 * t.fx / t.width, 1 - 2 * t.cx / t.width
    lens[1, 1], lens[1, 2] = 2 * t.fy / t.height, 2 * (t.cy + 1) / t.height - 1
    lens[2, 2], lens[2, 3], lens[3, 2] = -(far + near) / (far - near), -2 * far * near / (far - near), -1
    matrices = view.T.ravel().tolist(), lens.T.ravel().tolist()
    image = pybullet.getCameraImage(t.width, t.height, *matrices, renderer=pybullet.ER_TINY_RENDERER)
    buffer, seen = np.asarray(image[3], np.float32).reshape(t.mask.shape), np.asarray(image[4]).reshape(t.mask.shape) == 0
    code = {"depthCode": "z-buffer", "depthNear": near, "depthFar": far}
    # Outlines are drawn a pixel wider.
    limits = {"options": code, "limitM": 1e-4, "only": "mask", "share": 0.97}
    c.write("depth", "z-buffer of getCameraImage", "depth.npy", limits, np.save, buffer)
    c.write("mask", "segmentation of getCameraImage", "mask.npy", {"limitPixels": 260}, np.save, seen)
    pybullet.resetSimulation()

    scene = Scene(t)
    ids = {}
    for each in t.read("found", "urdf", "scene.json")["bodies"]:
        options = {"useFixedBase": each["fixed"], "flags": pybullet.URDF_USE_INERTIA_FROM_FILE}
        path = t.ours("found", "urdf", each["file"])
        ids[each["name"]] = pybullet.loadURDF(path, each["position"], each["quaternion"], **options)
    body = ids["body"]
    mass, _, moments, *local = pybullet.getDynamicsInfo(body, -1)[:5]
    center, turn = pybullet.getBasePositionAndOrientation(body)
    link = rigid(turn, center) @ np.linalg.inv(rigid(local[1], local[0]))
    c.measure("URDF", "pose of the link, matrix", link - scene.world_from_body, 1e-5)
    c.measure("URDF", "mass, kg", mass - scene.mass)
    c.measure("URDF", "centre of mass", center - scene.center, 1e-5)
    c.measure("URDF", "moments of inertia, relative", np.sort(moments) / scene.moments - 1, 1e-3)
    pybullet.setGravity(0, 0, -9.81)
    for _ in range(240):
        pybullet.stepSimulation()
    moved = np.subtract(center, pybullet.getBasePositionAndOrientation(body)[0])
    c.measure("URDF", "moved in a second of physics", np.linalg.norm(moved), 0.005)
    matrix = np.reshape(pybullet.getMatrixFromQuaternion(t.quaternion.tolist()), (3, 3))
    c.measure("pose", "quaternion as x, y, z, w", matrix - rotation(t.quaternion))


@program("yourdfpy")
def yourdfpy_(c, t):
    import yourdfpy

    robot = yourdfpy.URDF.load(t.ours("found", "urdf", "body.urdf"))
    c.points("URDF", "surface", robot.scene.to_mesh().vertices, t.points)
    c.measure("URDF", "mass, kg", robot.link_map["body"].inertial.mass - Scene(t).mass)
    c.measure("URDF", "faults found by validate()", not robot.validate(), 0)


@program("Newton")
def newton_(c, t):
    import newton
    import warp

    scene = Scene(t)
    xform = warp.transform(scene.body["position"], scene.body["rotation"])
    files = {"MJCF": ("mjcf", "scene.xml"), "USD": ("usd", "scene.usda"), "URDF": ("urdf", "body.urdf")}
    for form, path in files.items():
        builder = newton.ModelBuilder()
        options = {"xform": xform, "floating": True} if form == "URDF" else {}
        getattr(builder, f"add_{form.lower()}")(t.ours("found", *path), **options)
        # Of a URDF, the pose is that of its free joint.
        found = np.array(builder.joint_q[:7] if form == "URDF" else builder.body_q[0], float)
        c.measure(form, "pose of the body, matrix", rigid(found[3:], found[:3]) - scene.world_from_body, 1e-5)
        c.measure(form, "mass, kg", sum(builder.body_mass) - scene.mass, 1e-5)


@program("Drake")
def drake_(c, t):
    from pydrake.all import AddMultibodyPlantSceneGraph, DiagramBuilder, Parser, RigidTransform

    scene = Scene(t)
    for form, path in {"MJCF": ("mjcf", "scene.xml"), "URDF": ("urdf", "body.urdf")}.items():
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, 0.001)
        Parser(plant).AddModels(t.ours("found", *path))
        plant.Finalize()
        builder.Build()
        context, body = plant.CreateDefaultContext(), plant.GetBodyByName("body")
        if form == "URDF":
            plant.SetFreeBodyPose(context, body, RigidTransform(scene.world_from_body))
        place = plant.EvalBodyPoseInWorld(context, body).GetAsMatrix4()
        c.measure(form, "pose of the body, matrix", place - scene.world_from_body, 1e-5)
        c.measure(form, "mass, kg", body.get_mass(context) - scene.mass, 1e-5)


@program("SAPIEN")
def sapien_(c, t):
    import sapien

    scene = Scene(t)
    world = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    # Its visuals need a graphics card.
    text = Path(t.ours("found", "urdf", "body.urdf")).read_text()
    bare = Path(t.ours("found", "urdf", "body-bare.urdf"))
    bare.write_text(re.sub("<visual>.*?</visual>", "", text))
    # One link is an actor, which `load` refuses.
    _, [actor] = world.create_urdf_loader().load_multiple(str(bare))
    actor.set_pose(sapien.Pose(scene.body["position"], np.roll(scene.body["rotation"], 1)))
    body = actor.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    c.measure("URDF", "pose of the link, matrix", actor.pose.to_transformation_matrix() - scene.world_from_body, 1e-5)
    c.measure("URDF", "mass, kg", body.mass - scene.mass, 1e-5)
    c.measure("URDF", "centre of mass", body.cmass_local_pose.p - np.array(scene.body["centerOfMass"]), 1e-5)


@program("Mitsuba")
def mitsuba_(c, t):
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    vertices, faces = t.points.astype(np.float32), t.triangles.astype(np.uint32)
    mesh = mitsuba.Mesh("body", len(vertices), len(faces))
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"], parameters["faces"] = vertices.ravel(), faces.ravel()
    parameters.update()
    metres, millimetres = mitsuba.Bitmap(t.depth[..., None]), mitsuba.Bitmap(t.mm[..., None])
    c.write("mesh", "write_ply", "mesh.ply", {}, mesh.write_ply)
    c.write("depth", "EXR of a Bitmap", "depth.exr", {}, metres.write)
    c.write("depth", "PFM of a Bitmap", "depth.pfm", {}, metres.write)
    c.write("depth", "PNG of a Bitmap of 16 bits", "depth.png", MM, millimetres.write)
