"""Simulators and renderers, and readers of their files: they load our scenes."""

import re
from pathlib import Path

import numpy as np

from .cells import FLIP
from .truth import apply, rigid

FILES = {"MJCF": ("mjcf", "scene.xml"), "USD": ("usd", "scene.usda"), "URDF": ("urdf", "body.urdf")}


def mujoco(c, t):
    import mujoco
    import trimesh

    # Depth of MuJoCo's renderer needs a display; what it writes itself is the meshes of a model.
    def save(path):
        spec = mujoco.MjSpec()
        spec.add_mesh(name="body", uservert=t.points.ravel(), userface=t.triangles.ravel())
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="body")
        model = spec.compile()
        # A compiled mesh lies in the frame of its inertia.
        vertices = apply(rigid(np.roll(model.mesh_quat[0], -1), model.mesh_pos[0]), model.mesh_vert)
        trimesh.Trimesh(vertices, model.mesh_face, process=False).export(path)

    def load(*path):
        model = mujoco.MjModel.from_xml_path(t.ours(*path))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return model, data

    def principal_point():
        view, camera = mujoco.MjvScene(model, 100), mujoco.MjvCamera()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
        how = mujoco.MjvOption(), mujoco.MjvPerturb(), camera, mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, *how, view)
        lens = view.camera[0]
        u = (lens.frustum_width - lens.frustum_center) / (2 * lens.frustum_width) * t.width - 0.5
        return u, lens.frustum_top / (lens.frustum_top - lens.frustum_bottom) * t.height - 0.5

    c.writes(save=save)
    model, data = load("found", "mjcf", "scene.xml")
    visual = list(model.geom_group).index(2)
    first, count = model.mesh_vertadr[model.geom_dataid[visual]], model.mesh_vertnum[model.geom_dataid[visual]]
    frame = rigid(data.geom_xmat[visual].reshape(3, 3), data.geom_xpos[visual])
    surface = apply(frame, model.mesh_vert[first : first + count])
    eye = rigid(data.cam_xmat[0].reshape(3, 3), data.cam_xpos[0])
    c.loads(
        "MJCF",
        surface=surface,
        seen=apply(FLIP @ np.linalg.inv(eye), surface),
        mass=model.body_mass[1],
        center=data.xipos[1],
        moments=np.sort(model.body_inertia[1]),
        quaternion=np.roll(data.xquat[1], -1),
        principal=principal_point(),
    )

    model, data = load("rest", "mjcf", "scene.xml")
    before = data.xpos[1].copy()
    while data.time < 1:
        mujoco.mj_step(model, data)
    c.loads("MJCF", moved=np.linalg.norm(data.xpos[1] - before))
    # One link is welded to the world, and only its collisions are kept.
    c.loads("URDF", parts=load("found", "urdf", "body.urdf")[0].ngeom)


def pybullet(c, t):
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    near, far = 0.05, 5.0
    vertices, indices = t.points.tolist(), t.triangles.ravel().tolist()
    visual = pybullet.createVisualShape(pybullet.GEOM_MESH, vertices=vertices, indices=indices)
    pybullet.createMultiBody(0, -1, visual)
    # OpenGL's camera looks along -z. The software renderer looks through the lower left corner of each pixel.
    view = (FLIP @ t.matrix).T.ravel().tolist()
    left, right = -t.cx / t.fx, (t.width - t.cx) / t.fx
    bottom, top = (t.cy + 1 - t.height) / t.fy, (t.cy + 1) / t.fy
    lens = pybullet.computeProjectionMatrix(left * near, right * near, bottom * near, top * near, near, far)
    image = pybullet.getCameraImage(t.width, t.height, view, lens, renderer=pybullet.ER_TINY_RENDERER)
    buffer, seen = np.asarray(image[3], np.float32).reshape(t.mask.shape), np.asarray(image[4]).reshape(t.mask.shape) == 0
    c.writes(depth=lambda path: np.save(path, buffer), mask=lambda path: np.save(path, seen))

    pybullet.resetSimulation()
    ids = {}
    for each in t.read("found", "urdf", "scene.json")["bodies"]:
        options = {"useFixedBase": each["fixed"], "flags": pybullet.URDF_USE_INERTIA_FROM_FILE}
        path = t.ours("found", "urdf", each["file"])
        ids[each["name"]] = pybullet.loadURDF(path, each["position"], each["quaternion"], **options)
    body = ids["body"]
    mass, _, moments, *local = pybullet.getDynamicsInfo(body, -1)[:5]
    center, turn = pybullet.getBasePositionAndOrientation(body)
    link = rigid(turn, center) @ np.linalg.inv(rigid(local[1], local[0]))
    c.loads("URDF", matrix=link, mass=mass, center=center, moments=np.sort(moments))

    pybullet.setGravity(0, 0, -9.81)
    for _ in range(240):
        pybullet.stepSimulation()
    moved = np.subtract(center, pybullet.getBasePositionAndOrientation(body)[0])
    c.loads("URDF", moved=np.linalg.norm(moved))
    c.loads("pose", rotation=np.reshape(pybullet.getMatrixFromQuaternion(t.quaternion.tolist()), (3, 3)))


def yourdfpy(c, t):
    import yourdfpy

    robot = yourdfpy.URDF.load(t.ours("found", "urdf", "body.urdf"))
    mass = robot.link_map["body"].inertial.mass
    c.loads("URDF", body=robot.scene.to_mesh().vertices, mass=mass, valid=robot.validate())


def newton(c, t):
    import newton
    import warp

    scene = t.read("found", "scene.json")
    xform = warp.transform(scene["position"], scene["rotation"])
    for form, path in FILES.items():
        builder = newton.ModelBuilder()
        options = {"xform": xform, "floating": True} if form == "URDF" else {}
        getattr(builder, f"add_{form.lower()}")(t.ours("found", *path), **options)
        # Of a URDF, the pose is that of its free joint.
        found = np.array(builder.joint_q[:7] if form == "URDF" else builder.body_q[0], float)
        c.loads(form, matrix=rigid(found[3:], found[:3]), mass=sum(builder.body_mass))


def drake(c, t):
    from pydrake.all import AddMultibodyPlantSceneGraph, DiagramBuilder, Parser, RigidTransform

    scene = t.read("found", "scene.json")
    for form in ("MJCF", "URDF"):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, 0.001)
        Parser(plant).AddModels(t.ours("found", *FILES[form]))
        plant.Finalize()
        builder.Build()
        context, body = plant.CreateDefaultContext(), plant.GetBodyByName("body")
        if form == "URDF":
            plant.SetFreeBodyPose(context, body, RigidTransform(rigid(scene["rotation"], scene["position"])))
        c.loads(form, matrix=plant.EvalBodyPoseInWorld(context, body).GetAsMatrix4(), mass=body.get_mass(context))


def sapien(c, t):
    import sapien

    scene = t.read("found", "scene.json")
    world = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    # Its visuals need a graphics card.
    text = Path(t.ours("found", "urdf", "body.urdf")).read_text()
    bare = Path(t.ours("found", "urdf", "body-bare.urdf"))
    bare.write_text(re.sub("<visual>.*?</visual>", "", text))
    # One link is an actor, which `load` refuses.
    _, [actor] = world.create_urdf_loader().load_multiple(str(bare))
    actor.set_pose(sapien.Pose(scene["position"], np.roll(scene["rotation"], 1)))
    body = actor.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    c.loads("URDF", matrix=actor.pose.to_transformation_matrix(), mass=body.mass, center=body.cmass_local_pose.p)


def mitsuba(c, t):
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    vertices, faces = t.points.astype(np.float32), t.triangles.astype(np.uint32)
    mesh = mitsuba.Mesh("body", len(vertices), len(faces))
    parameters = mitsuba.traverse(mesh)
    parameters["vertex_positions"], parameters["faces"] = vertices.ravel(), faces.ravel()
    parameters.update()
    c.writes(mesh=mesh.write_ply, bitmap=lambda path, array: mitsuba.Bitmap(array).write(path))
