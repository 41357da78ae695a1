"""Programs of meshes: they write the known body in each of their formats, and load our meshes."""

from operator import attrgetter

import numpy as np

from .cells import FLIP
from .truth import apply


def trimesh(c, t):
    import trimesh
    from PIL import Image
    from trimesh.visual import ColorVisuals, TextureVisuals

    image = Image.open(t.texture)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0)
    prints = {
        "plain": None,
        "vertex": ColorVisuals(vertex_colors=t.rgba),
        "grey": ColorVisuals(vertex_colors=np.full_like(t.rgba, 188)),
        "face": ColorVisuals(face_colors=t.face_rgba),
        "simple": TextureVisuals(uv=t.uv, image=image),
        "PBR": TextureVisuals(uv=t.uv, material=material),
    }

    def body(print_, points=t.points):
        return trimesh.Trimesh(points, t.triangles, process=False, visual=prints[print_])

    def halves(path):
        parts = np.arange(len(t.triangles)).reshape(2, -1)
        trimesh.Scene([body("plain").submesh([part])[0] for part in parts]).export(path)

    def node(path, angle, scales):
        matrix = trimesh.transformations.rotation_matrix(angle, [1, 2, 3], [0.1, 0.2, 0.3]) @ np.diag([*scales, 1])
        # Of a mirrored body its own inside is out before the node mirrors it back.
        inner = body("vertex").apply_transform(np.linalg.inv(matrix))
        placed = trimesh.Scene()
        placed.add_geometry(inner, transform=matrix)
        placed.export(path)

    c.writes(export=lambda path, print_, **options: body(print_).export(path, **options), halves=halves, node=node)
    c.meshes(lambda path: trimesh.load(path, force="mesh").vertices)
    box = body("plain", t.turned)
    c.loads("box", extents=box.extents.max(), oriented=max(box.bounding_box_oriented.primitive.extents))


def open3d(c, t):
    import open3d as o3d

    prints = {"vertex": t.colors / 255.0, "grey": np.full(t.points.shape, 188 / 255.0)}

    def body(print_):
        vertices, triangles = o3d.utility.Vector3dVector(t.points), o3d.utility.Vector3iVector(t.triangles)
        mesh = o3d.geometry.TriangleMesh(vertices, triangles)
        if print_ in prints:
            mesh.vertex_colors = o3d.utility.Vector3dVector(prints[print_])
        if print_ == "texture":
            mesh.triangle_uvs = o3d.utility.Vector2dVector(t.uv[t.triangles].reshape(-1, 2))
            # Open3D keeps textures from the bottom up, and turns them round when it reads and writes files.
            mesh.textures = [o3d.geometry.Image(np.ascontiguousarray(np.asarray(o3d.io.read_image(t.texture))[::-1]))]
            mesh.triangle_material_ids = o3d.utility.IntVector([0] * len(t.triangles))
        mesh.compute_vertex_normals()
        return mesh

    def cloud(points):
        return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))

    tensor = o3d.t.geometry.TriangleMesh.from_legacy(body("vertex"))
    c.writes(
        save=lambda path, print_, **options: o3d.io.write_triangle_mesh(path, body(print_), **options),
        tensor=lambda path: o3d.t.io.write_triangle_mesh(path, tensor),
    )
    c.meshes(lambda path: o3d.io.read_triangle_mesh(path).vertices)
    # Rows, as `toRowMajor` returns them; the extrinsic of a camera.
    matrix = np.reshape(t.read("poses.json")["opencv"]["rows"], (4, 4))
    c.loads("pose", transform=cloud(t.points / 0.25).transform(matrix).points)
    turned = cloud(t.turned)
    oriented, minimal = turned.get_oriented_bounding_box(), turned.get_minimal_oriented_bounding_box()
    c.loads("box", oriented=max(oriented.extent), minimal=max(minimal.extent))

    lens = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.K)
    ones = o3d.geometry.Image(np.ones(t.depth.shape, np.float32))
    points = o3d.geometry.PointCloud.create_from_depth_image(ones, lens, depth_scale=1.0).points
    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(t.K, np.eye(4), t.width, t.height).numpy()
    c.loads("pixel", rays=rays[0, 0, 3] / rays[0, 0, 5] * t.fx + t.cx, cloud=points[0][0] * t.fx + t.cx)

    # A wall at 1 m, in the corner of the image.
    scene = o3d.t.geometry.RaycastingScene()
    corners = np.array([[-9, -9, 1], [9, -9, 1], [9, 9, 1], [-9, 9, 1]], np.float32)
    scene.add_triangles(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    corner = np.linalg.inv(t.K) @ [0, 0, 1]
    both = np.array([rays[0, 0], [0, 0, 0, *corner / np.linalg.norm(corner)]], np.float32)
    pinhole, normed = scene.cast_rays(o3d.core.Tensor(both))["t_hit"].numpy()
    c.loads("ray", pinhole=pinhole, normed=normed)


def pymeshlab(c, t):
    import pymeshlab

    prints = {"plain": {}, "vertex": {"v_color_matrix": t.rgba / 255.0}, "face": {"f_color_matrix": t.face_rgba / 255.0}}

    def save(path, print_, **options):
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(t.points, t.triangles, **prints[print_]), "body")
        meshes.save_current_mesh(path, **options)

    def load(path):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(path)
        return np.concatenate([each.transformed_vertex_matrix() for each in meshes])

    c.writes(save=save)
    c.meshes(load)


def meshio(c, t):
    import meshio

    colors = dict(zip(("red", "green", "blue"), t.colors.T))
    plain = meshio.Mesh(t.points, [("triangle", t.triangles)])
    printed = meshio.Mesh(t.points, [("triangle", t.triangles)], point_data=colors)
    c.writes(plain=plain.write, printed=printed.write)


def plyfile(c, t):
    from plyfile import PlyData, PlyElement

    def save(path, text=False, order="<", number="f4", wide="u1", faces="i4"):
        # 16-bit colours have the whole range, floats 0 to 1.
        factor = {"u1": 1, "u2": 257, "f4": 1 / 255.0}[wide]
        names = [(axis, number) for axis in "xyz"] + [(each, wide) for each in ("red", "green", "blue")]
        rows = [(*point, *color) for point, color in zip(t.points, t.colors.astype(int) * factor)]
        vertex = PlyElement.describe(np.array(rows, dtype=names), "vertex")
        face = np.empty(len(t.triangles), dtype=[("vertex_indices", faces, (3,))])
        face["vertex_indices"] = t.triangles
        described = PlyElement.describe(face, "face", len_types={"vertex_indices": "u1"})
        PlyData([vertex, described], text=text, byte_order=order).write(path)

    def splats(path):
        rows = PlyData.read(path)["vertex"]
        return np.stack([rows[axis] for axis in "xyz"], 1), np.stack([rows[f"scale_{k}"] for k in range(3)], 1)

    c.writes(save=save)
    source = t.read("splats.json")
    (before, sizes), (after, grown) = splats(source["source"]), splats(t.ours("splats.ply"))
    moved = apply(t.matrix, before * source["scale"]) - after
    c.loads("splats", moved=np.r_[moved, grown - sizes - np.log(source["scale"])])


def numpy_stl(c, t):
    from stl import Mode, mesh

    body = mesh.Mesh(np.zeros(len(t.triangles), dtype=mesh.Mesh.dtype))
    body.vectors[:] = t.points[t.triangles]
    c.writes(save=lambda path, mode: body.save(path, mode=Mode[mode]))


def usd_core(c, t):
    from pxr import Gf, Usd, UsdGeom, UsdPhysics

    def world_from(prim):
        return np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim)).T

    stage = Usd.Stage.Open(t.ours("found", "usd", "scene.usda"))
    prims = list(stage.Traverse())
    meshes = [UsdGeom.Mesh(prim) for prim in prims if prim.IsA(UsdGeom.Mesh) and "body" in str(prim.GetPath())]
    visible = [mesh for mesh in meshes if mesh.ComputePurpose() != "guide"]
    surface = np.concatenate([apply(world_from(mesh.GetPrim()), mesh.GetPointsAttr().Get()) for mesh in visible])
    eye = next(prim for prim in prims if prim.IsA(UsdGeom.Camera))
    body = next(prim for prim in prims if prim.HasAPI(UsdPhysics.MassAPI))

    window = UsdGeom.Camera(eye).GetCamera(Usd.TimeCode.Default()).frustum.GetWindow()
    (left, bottom), (right, top) = window.GetMin(), window.GetMax()
    fx, fy = t.width / (right - left), t.height / (top - bottom)
    c.loads(
        "USD",
        surface=surface,
        seen=apply(FLIP @ np.linalg.inv(world_from(eye)), surface),
        lens=[fx, fy, -left * fx - 0.5, top * fy - 0.5],
        mass=UsdPhysics.MassAPI(body).GetMassAttr().Get(),
        metres=UsdGeom.GetStageMetersPerUnit(stage) if UsdGeom.GetStageUpAxis(stage) == "Z" else 0,
    )
    c.loads("pose", rotation=np.array(Gf.Matrix3d(Gf.Quatd(*map(float, np.roll(t.quaternion, 1))))).T)


def blender(c, t):
    import bpy
    from mathutils import Matrix, Quaternion

    def link(name, data):
        made = bpy.data.objects.new(name, data)
        bpy.context.collection.objects.link(made)
        return made

    def operate(path, operator, **options):
        attrgetter(operator)(bpy.ops)(filepath=path, **options)

    def save(path, operator, print_="plain", parent=False, **options):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        data = bpy.data.meshes.new("body")
        data.from_pydata(t.points.tolist(), [], t.triangles.tolist())
        body = link("body", data)
        material = bpy.data.materials.new("print")
        material.use_nodes = True
        tree = material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")

        if print_ in ("BYTE_COLOR", "FLOAT_COLOR"):
            layer = data.color_attributes.active_color = data.color_attributes.new("Color", print_, "POINT")
            layer.data.foreach_set("color", np.c_[t.lights, np.ones(len(t.lights))].ravel())
            source = tree.nodes.new("ShaderNodeVertexColor")
            source.layer_name = "Color"
        if print_ == "texture":
            data.uv_layers.new(name="UVMap").data.foreach_set("uv", t.uv[t.triangles].ravel())
            source = tree.nodes.new("ShaderNodeTexImage")
            source.image = bpy.data.images.load(t.texture)
        if print_ != "plain":
            tree.links.new(source.outputs["Color"], shader.inputs["Base Color"])
            data.materials.append(material)
        if parent:
            # In centimetres below an empty that is turned and scaled.
            above = link("above", None)
            above.scale, above.rotation_euler = (0.01,) * 3, (0.3, 0.4, 0.5)
            bpy.context.view_layer.update()
            body.parent, body.matrix_parent_inverse = above, above.matrix_world.inverted()

        bpy.context.view_layer.objects.active = body
        body.select_set(True)
        operate(path, operator, **options)

    def load(path):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        imports = {"glb": "import_scene.gltf", "ply": "wm.ply_import", "usda": "wm.usd_import"}
        operate(path, imports[path.split(".")[-1]])
        bpy.context.view_layer.update()
        meshes = [each for each in bpy.context.scene.objects if each.type == "MESH" and "ground" not in each.name.lower()]
        points = np.array([each.matrix_world @ v.co for each in meshes for v in each.data.vertices])
        # Its import of glTF turns y up to z up.
        return points[:, [0, 2, 1]] * [1, 1, -1] if path.endswith("glb") else points

    c.writes(save=save)
    c.meshes(load)
    surface = load(t.ours("found", "usd", "scene.usda"))
    eye = next(each for each in bpy.context.scene.objects if each.type == "CAMERA")
    seen = apply(FLIP @ np.linalg.inv(np.array(eye.matrix_world)), surface)
    c.loads("USD", surface=surface, seen=seen, focal=eye.data.lens / eye.data.sensor_width * t.width)

    bpy.ops.wm.read_factory_settings(use_empty=True)
    eye, body = link("eye", bpy.data.cameras.new("eye")), link("body", None)
    eye.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, "Y")
    bpy.context.view_layer.update()
    opengl = np.reshape(t.read("poses.json")["opengl"]["matrix"], (4, 4)).T
    body.matrix_world = eye.matrix_world @ Matrix(opengl.tolist())
    bpy.context.view_layer.update()
    inside = np.array(eye.matrix_world.inverted() @ body.matrix_world)
    quaternion = Quaternion(np.roll(t.quaternion, 1).tolist())
    c.loads("pose", rotation=np.array(quaternion.to_matrix()), below=apply(FLIP @ inside, t.points / 0.25))
