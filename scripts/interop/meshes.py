"""Programs of meshes: they write the known body in each of their formats, and load our meshes."""

import os
import tempfile

import numpy as np

from .cells import FLIP, REFUSED, Scene, apply, nearest, program, rotation
from .places import BOX, GREY, PIXEL, RAY, grey, turned

USD = REFUSED | {"says": "USD"}
VERTEX, TEXTURE, FACE = ({"colors": each} for each in ("vertex", "texture", "face"))
# A quarter turn about x: z up becomes y up.
YUP = {"axes": "y-up"}


def with_alpha(colors):
    return np.c_[colors, np.full(len(colors), 255, np.uint8)]


@program("trimesh")
def trimesh_(c, t):
    import trimesh
    from PIL import Image
    from trimesh.visual import ColorVisuals, TextureVisuals

    def body(visual=None):
        return trimesh.Trimesh(t.points, t.triangles, process=False, visual=visual)

    plain = body()
    printed = body(ColorVisuals(vertex_colors=with_alpha(t.colors)))
    faces = body(ColorVisuals(face_colors=with_alpha(t.face_colors)))
    image = Image.open(t.texture)
    simple = body(TextureVisuals(uv=t.uv, image=image))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0)
    pbr = body(TextureVisuals(uv=t.uv, material=material))
    halves = trimesh.Scene([body().submesh([half])[0] for half in np.arange(256).reshape(2, 128)])
    c.write("mesh", "STL, text", "mesh.stl", {}, plain.export, file_type="stl_ascii")
    c.write("mesh", "PLY, text", "mesh.ply", VERTEX, printed.export, encoding="ascii")
    # The grey of a default material, 0.4, becomes a factor of the texture in glTF.
    grey_factor = {"colors": "texture", "colorFactor": 0.4}
    for what, mesh, expect, formats in (
        (" plain", plain, {}, "glb gltf obj ply stl"),
        (", colours of vertices", printed, VERTEX, "glb gltf obj ply"),
        (", colours of faces", faces, FACE, "glb ply"),
        (", texture (simple material)", simple, grey_factor, "glb gltf"),
        (", texture (simple material)", simple, TEXTURE, "obj"),
        (", texture (PBR material)", pbr, TEXTURE, "glb gltf obj"),
        # Without the name of the picture, a PLY has coordinates of a texture only.
        (", texture (simple material)", simple, {"warns": "texture"}, "ply"),
        (", texture (PBR material)", pbr, {"warns": "texture"}, "ply"),
        (", scene of two parts", halves, {}, "glb obj ply stl"),
        ("", plain, REFUSED, "off dae 3mf"),
    ):
        for format in formats.split():
            c.write("mesh", f"{format}{what}", f"mesh.{format}", expect, mesh.export)
    turn = trimesh.transformations.rotation_matrix(1.0, [1, 2, 3], [0.1, 0.2, 0.3])
    for name, matrix in (
        ("node in millimetres", np.diag([0.001, 0.001, 0.001, 1])),
        ("turned node", turn),
        ("node with three scales", turn @ np.diag([0.5, 2, 3, 1])),
        ("mirrored node", np.diag([-1.0, 1, 1, 1])),
    ):
        # Of a mirrored body its own inside is out before the node mirrors it back.
        inner = body(printed.visual.copy()).apply_transform(np.linalg.inv(matrix))
        placed = trimesh.Scene()
        placed.add_geometry(inner, transform=matrix)
        c.write("mesh", f"glb, {name}", "mesh.glb", VERTEX | {"limitM": 2e-6}, placed.export)

    def load(path):
        # Its Scene joins the geometry with the transforms of the nodes.
        scene = trimesh.load(path, force="scene")
        return (scene.to_mesh() if hasattr(scene, "to_mesh") else scene.dump(concatenate=True)).vertices

    c.meshes(t, load)
    box = trimesh.Trimesh(turned(t.points), t.triangles, process=False)
    c.place(BOX, "`extents`", box.extents.max(), 0.181, 0.001)
    c.place(BOX, "`bounding_box_oriented`", max(box.bounding_box_oriented.primitive.extents), 0.17, 0.001)
    box.visual.vertex_colors = np.full((len(t.points), 4), [188, 188, 188, 255], np.uint8)
    with tempfile.TemporaryDirectory() as folder:
        box.export(path := os.path.join(folder, "a.glb"))
        c.place(GREY, "byte, sRGB-encoded", grey(path), 188)


@program("Open3D")
def open3d_(c, t):
    import open3d as o3d

    def body(kind, colors=t.colors):
        vertices, triangles = o3d.utility.Vector3dVector(t.points), o3d.utility.Vector3iVector(t.triangles)
        mesh = o3d.geometry.TriangleMesh(vertices, triangles)
        if kind == "vertex":
            mesh.vertex_colors = o3d.utility.Vector3dVector(colors / 255.0)
        if kind == "texture":
            mesh.triangle_uvs = o3d.utility.Vector2dVector(t.uv[t.triangles].reshape(-1, 2))
            # Open3D keeps textures from the bottom up, and turns them round when it reads and writes files.
            mesh.textures = [o3d.geometry.Image(np.ascontiguousarray(np.asarray(o3d.io.read_image(t.texture))[::-1]))]
            mesh.triangle_material_ids = o3d.utility.IntVector([0] * len(t.triangles))
        mesh.compute_vertex_normals()
        return mesh

    def save(path, kind, **options):
        assert o3d.io.write_triangle_mesh(path, body(kind), **options), "refused"

    def tensor(path):
        assert o3d.t.io.write_triangle_mesh(path, o3d.t.geometry.TriangleMesh.from_legacy(body("vertex"))), "refused"

    for format in ("glb", "gltf", "obj", "ply"):
        c.write("mesh", f"{format}, colours of vertices", f"mesh.{format}", VERTEX, save, "vertex")
    for format in ("glb", "obj", "ply", "stl"):
        c.write("mesh", f"{format}, tensor", f"mesh.{format}", {} if format == "stl" else VERTEX, tensor)
    c.write("mesh", "ply, text", "mesh.ply", VERTEX, save, "vertex", write_ascii=True)
    c.write("mesh", "ply, compressed=True", "mesh.ply", VERTEX, save, "vertex", compressed=True)
    c.write("mesh", "stl", "mesh.stl", {}, save, "plain")
    c.write("mesh", "obj, texture", "mesh.obj", TEXTURE, save, "texture")
    # Its GLB has neither the texture nor its coordinates.
    c.write("mesh", "glb, texture", "mesh.glb", {}, save, "texture")
    c.write("mesh", "off", "mesh.off", REFUSED, save, "plain")

    c.meshes(t, lambda path: np.asarray(o3d.io.read_triangle_mesh(path).vertices))
    # Rows, as `toRowMajor` returns them; the extrinsic of a camera.
    matrix = np.reshape(t.read("poses.json")["opencv"]["rows"], (4, 4))
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(t.points / 0.25)).transform(matrix)
    c.points("pose", "toRowMajor with PointCloud.transform", np.asarray(cloud.points), t.placed)

    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(t.K, np.eye(4), t.width, t.height).numpy()
    c.place(PIXEL, "`create_rays_pinhole`", rays[0, 0, 3] / rays[0, 0, 5] * t.fx + t.cx, 0.5, 1e-3)
    lens = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.K)
    image = o3d.geometry.Image(np.ones(t.depth.shape, np.float32))
    cloud = np.asarray(o3d.geometry.PointCloud.create_from_depth_image(image, lens, depth_scale=1.0).points)
    c.place(PIXEL, "`create_from_depth_image`", cloud[0, 0] * t.fx + t.cx, 0, 1e-3)
    scene = o3d.t.geometry.RaycastingScene()
    corners = np.array([[-9, -9, 1], [9, -9, 1], [9, 9, 1], [-9, 9, 1]], np.float32)
    scene.add_triangles(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    unit = np.linalg.inv(t.K) @ [0, 0, 1]
    unit /= np.linalg.norm(unit)
    both = np.array([rays[0, 0], [0, 0, 0, *unit]], np.float32)
    pinhole, normed = scene.cast_rays(o3d.core.Tensor(both))["t_hit"].numpy()
    c.place(RAY, "`t_hit` of `create_rays_pinhole`", pinhole, 1, 1e-5)
    c.place(RAY, "`t_hit` of rays of length 1", normed, 1 / unit[2], 1e-5)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(turned(t.points)))
    c.place(BOX, "`get_oriented_bounding_box`", max(cloud.get_oriented_bounding_box().extent), 0.186, 0.001)
    c.place(BOX, "`get_minimal_oriented_bounding_box`", max(cloud.get_minimal_oriented_bounding_box().extent), 0.17, 0.001)
    with tempfile.TemporaryDirectory() as folder:
        o3d.io.write_triangle_mesh(path := os.path.join(folder, "a.glb"), body("vertex", np.full(t.points.shape, 188)))
        c.place(GREY, "float times 255, sRGB-encoded, against the standard", 255 * grey(path), 188, 0.5)


@program("PyMeshLab")
def pymeshlab_(c, t):
    import pymeshlab

    colors = {
        "plain": {},
        "vertex": {"v_color_matrix": with_alpha(t.colors) / 255.0},
        "face": {"f_color_matrix": with_alpha(t.face_colors) / 255.0},
    }

    def save(path, kind, **options):
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(t.points, t.triangles, **colors[kind]), "body")
        meshes.save_current_mesh(path, **options)

    faces = {"save_face_color": True, "save_vertex_color": False}
    c.write("mesh", "ply", "mesh.ply", VERTEX, save, "vertex")
    c.write("mesh", "ply, text", "mesh.ply", VERTEX, save, "vertex", binary=False)
    c.write("mesh", "ply, colours of faces", "mesh.ply", FACE, save, "face", **faces)
    c.write("mesh", "obj", "mesh.obj", VERTEX, save, "vertex", save_vertex_color=True)
    c.write("mesh", "obj, colours of faces", "mesh.obj", FACE, save, "face", **faces)
    c.write("mesh", "stl", "mesh.stl", {}, save, "plain")
    c.write("mesh", "stl, colours of faces", "mesh.stl", FACE | {"colorLimit": 14}, save, "face", save_face_color=True)
    c.write("mesh", "stl, text", "mesh.stl", {}, save, "plain", binary=False)
    for format in ("off", "3mf", "dae", "wrl", "x3d", "ctm"):
        c.write("mesh", format, f"mesh.{format}", REFUSED, save, "plain")

    def load(path):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(path)
        return np.concatenate([each.transformed_vertex_matrix() for each in meshes])

    c.meshes(t, load)


@program("meshio")
def meshio_(c, t):
    import meshio

    colors = dict(zip(("red", "green", "blue"), t.colors.T))
    plain = meshio.Mesh(t.points, [("triangle", t.triangles)])
    printed = meshio.Mesh(t.points, [("triangle", t.triangles)], point_data=colors)
    c.write("mesh", "obj", "mesh.obj", {}, plain.write)
    c.write("mesh", "ply", "mesh.ply", VERTEX, printed.write)
    c.write("mesh", "ply, text", "mesh.ply", VERTEX, printed.write, binary=False)
    c.write("mesh", "stl", "mesh.stl", {}, plain.write, binary=True)
    c.write("mesh", "stl, text", "mesh.stl", {}, plain.write, binary=False)
    for format in ("off", "vtk", "vtu"):
        c.write("mesh", format, f"mesh.{format}", REFUSED, plain.write)
    c.points("PLY", "exportPly", meshio.read(t.ours("placed.ply")).points, t.placed)
    surface = meshio.read(t.ours("found", "urdf", "meshes", "body.obj"))
    c.points("URDF", "OBJ of the surface", surface.points, t.points)


@program("plyfile")
def plyfile_(c, t):
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

    c.write("mesh", "ply", "mesh.ply", VERTEX, save)
    c.write("mesh", "ply, text", "mesh.ply", VERTEX, save, text=True)
    c.write("mesh", "ply, big-endian", "mesh.ply", VERTEX, save, order=">")
    c.write("mesh", "ply, doubles", "mesh.ply", VERTEX, save, number="f8", faces="u4")
    c.write("mesh", "ply, colours of 16 bits", "mesh.ply", VERTEX, save, wide="u2")
    c.write("mesh", "ply, colours as floats", "mesh.ply", VERTEX, save, wide="f4")

    source = t.read("splats.json")
    before, after = (PlyData.read(each)["vertex"] for each in (source["source"], t.ours("splats.ply")))
    places = lambda rows: np.c_[rows["x"], rows["y"], rows["z"]]
    grown = [after[f"scale_{k}"] - before[f"scale_{k}"] - np.log(source["scale"]) for k in range(3)]
    moved = apply(t.matrix, places(before) * source["scale"]) - places(after)
    c.measure("splats", "places, and logarithms of sizes", np.r_[moved.ravel(), np.ravel(grown)], 2e-6, "m")


@program("numpy-stl")
def numpy_stl(c, t):
    from stl import Mode, mesh

    body = mesh.Mesh(np.zeros(len(t.triangles), dtype=mesh.Mesh.dtype))
    body.vectors[:] = t.points[t.triangles]
    c.write("mesh", "stl", "mesh.stl", {}, body.save, mode=Mode.BINARY)
    c.write("mesh", "stl, text", "mesh.stl", {"limitM": 1e-6}, body.save, mode=Mode.ASCII)


@program("usd-core")
def usd_(c, t):
    from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdUtils

    def save(path):
        stage = Usd.Stage.CreateNew(path)
        mesh = UsdGeom.Mesh.Define(stage, "/body")
        mesh.CreatePointsAttr(t.points.astype(np.float32).tolist())
        mesh.CreateFaceVertexCountsAttr([3] * len(t.triangles))
        mesh.CreateFaceVertexIndicesAttr(t.triangles.ravel().tolist())
        stage.SetDefaultPrim(mesh.GetPrim())
        stage.GetRootLayer().Save()

    def pack(path):
        save(inner := path.replace(".usdz", ".usdc"))
        assert UsdUtils.CreateNewUsdzPackage(inner, path)
        os.remove(inner)

    c.write("mesh", "usda", "mesh.usda", USD, save)
    c.write("mesh", "usdc", "mesh.usdc", USD, save)
    c.write("mesh", "usdz", "mesh.usdz", USD, pack)

    scene = Scene(t)
    stage = Usd.Stage.Open(t.ours("found", "usd", "scene.usda"))
    matrix = lambda prim: np.array(UsdGeom.XformCache().GetLocalToWorldTransform(prim)).T
    prims = list(stage.Traverse())
    meshes = [UsdGeom.Mesh(prim) for prim in prims if prim.IsA(UsdGeom.Mesh) and "body" in str(prim.GetPath())]
    visible = [mesh for mesh in meshes if mesh.ComputePurpose() != "guide"]
    surface = np.concatenate([apply(matrix(mesh.GetPrim()), mesh.GetPointsAttr().Get()) for mesh in visible])
    eye = next(prim for prim in prims if prim.IsA(UsdGeom.Camera))
    body = next(prim for prim in prims if prim.HasAPI(UsdPhysics.MassAPI))
    window = UsdGeom.Camera(eye).GetCamera(Usd.TimeCode.Default()).frustum.GetWindow()
    (left, bottom), (right, top) = window.GetMin(), window.GetMax()
    fx, fy = t.width / (right - left), t.height / (top - bottom)
    lens = [fx - t.fx, fy - t.fy, -left * fx - 0.5 - t.cx, top * fy - 0.5 - t.cy]
    turn = np.array(Gf.Matrix3d(Gf.Quatd(*map(float, np.roll(t.quaternion, 1))))).T
    unit = [UsdGeom.GetStageMetersPerUnit(stage) - 1, UsdGeom.GetStageUpAxis(stage) != "Z"]
    seen = apply(FLIP @ np.linalg.inv(matrix(eye)), surface)
    c.points("USD", "surface of the body", surface, scene.points)
    c.points("USD", "the body seen by its camera", seen, t.placed)
    c.measure("USD", "focal lengths and principal point, pixels", lens, 1e-3)
    c.measure("USD", "mass, kg", UsdPhysics.MassAPI(body).GetMassAttr().Get() - scene.mass)
    c.measure("USD", "metres, z up", unit, 0)
    c.measure("pose", "quaternion as w, x, y, z", turn - rotation(t.quaternion))


@program("Blender")
def blender_(c, t):
    import bpy
    from mathutils import Matrix, Quaternion

    def link(name, data):
        made = bpy.data.objects.new(name, data)
        bpy.context.collection.objects.link(made)
        return made

    def operate(path, operator, **options):
        folder, name = operator.split(".")
        getattr(getattr(bpy.ops, folder), name)(filepath=path, **options)

    def scene(kind, parent=False):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        data = bpy.data.meshes.new("body")
        data.from_pydata(t.points.tolist(), [], t.triangles.tolist())
        body = link("body", data)
        material = bpy.data.materials.new("print")
        material.use_nodes = True
        tree = material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        if kind in ("BYTE_COLOR", "FLOAT_COLOR"):
            layer = data.color_attributes.new("Color", kind, "POINT")
            data.color_attributes.active_color = layer
            for i, color in enumerate(t.linear):
                layer.data[i].color = (*color, 1)
            source = tree.nodes.new("ShaderNodeVertexColor")
            source.layer_name = "Color"
        if kind == "texture":
            uv = data.uv_layers.new(name="UVMap")
            for loop in data.loops:
                uv.data[loop.index].uv = t.uv[loop.vertex_index]
            source = tree.nodes.new("ShaderNodeTexImage")
            source.image = bpy.data.images.load(t.texture)
        if kind != "plain":
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

    def save(path, operator, kind="plain", parent=False, **options):
        scene(kind, parent)
        operate(path, operator, **options)

    glb, obj, ply, stl = "export_scene.gltf", "wm.obj_export", "wm.ply_export", "wm.stl_export"
    separate, srgb = {"export_format": "GLTF_SEPARATE"}, {"export_colors": "SRGB"}
    lossy = {"colorLimit": 6, **YUP}
    draco = {"export_draco_mesh_compression_enable": True, "export_draco_position_quantization": 16}
    for kind in ("BYTE_COLOR", "FLOAT_COLOR"):
        c.write("mesh", f"GLB, {kind}", "mesh.glb", YUP | VERTEX, save, glb, kind)
        c.write("mesh", f"GLTF_SEPARATE, {kind}", "mesh.gltf", YUP | VERTEX, save, glb, kind, **separate)
        c.write("mesh", f"PLY, {kind}", "mesh.ply", VERTEX, save, ply, kind, **srgb)
        c.write("mesh", f"PLY, text, {kind}", "mesh.ply", VERTEX, save, ply, kind, ascii_format=True, **srgb)
    c.write("mesh", "GLB, texture", "mesh.glb", YUP | TEXTURE, save, glb, "texture")
    c.write("mesh", "glTF, texture", "mesh.gltf", YUP | TEXTURE, save, glb, "texture", **separate)
    c.write("mesh", "GLB, JPEG", "mesh.glb", lossy | TEXTURE, save, glb, "texture", export_image_format="JPEG")
    c.write("mesh", "GLB, WebP", "mesh.glb", lossy | TEXTURE, save, glb, "texture", export_image_format="WEBP")
    c.write("mesh", "GLB, z up", "mesh.glb", VERTEX, save, glb, "FLOAT_COLOR", export_yup=False)
    c.write("mesh", "GLB below a scaled empty", "mesh.glb", YUP | VERTEX | {"limitM": 1e-6}, save, glb, "FLOAT_COLOR", True)
    c.write("mesh", "GLB, Draco", "mesh.glb", lossy | VERTEX | {"limitM": 1e-5}, save, glb, "FLOAT_COLOR", **draco)
    c.write("mesh", "OBJ", "mesh.obj", YUP, save, obj)
    c.write("mesh", "OBJ, colours of vertices", "mesh.obj", YUP | VERTEX, save, obj, "FLOAT_COLOR", export_colors=True)
    c.write("mesh", "OBJ, texture", "mesh.obj", YUP | TEXTURE, save, obj, "texture", path_mode="COPY")
    c.write("mesh", "OBJ, z up", "mesh.obj", {}, save, obj, forward_axis="Y", up_axis="Z")
    c.write("mesh", "OBJ in millimetres", "mesh.obj", YUP | {"unit": 1000}, save, obj, global_scale=1000.0)
    c.write("mesh", "PLY", "mesh.ply", {}, save, ply)
    c.write("mesh", "STL", "mesh.stl", {}, save, stl)
    c.write("mesh", "STL, text", "mesh.stl", {"limitM": 1e-6}, save, stl, ascii_format=True)
    c.write("mesh", "FBX", "mesh.fbx", REFUSED | {"says": "FBX"}, save, "export_scene.fbx")
    c.write("mesh", "USD", "mesh.usdc", USD, save, "wm.usd_export")

    def load(path):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        imports = {"glb": "import_scene.gltf", "ply": "wm.ply_import", "usda": "wm.usd_import"}
        operate(path, imports[path.split(".")[-1]])
        bpy.context.view_layer.update()
        meshes = [each for each in bpy.context.scene.objects if each.type == "MESH" and "ground" not in each.name.lower()]
        points = np.array([each.matrix_world @ v.co for each in meshes for v in each.data.vertices])
        # Its import of glTF turns y up to z up.
        return points[:, [0, 2, 1]] * [1, 1, -1] if path.endswith("glb") else points

    c.meshes(t, load)
    wanted = Scene(t).points
    c.points("USD", "surface of the body", wanted, load(t.ours("found", "usd", "scene.usda")), distance=nearest)
    eye = next(each for each in bpy.context.scene.objects if each.type == "CAMERA")
    seen = apply(FLIP @ np.linalg.inv(np.array(eye.matrix_world)), wanted)
    c.points("USD", "the body seen by its camera", seen, t.placed)
    c.measure("USD", "focal length, pixels", eye.data.lens / eye.data.sensor_width * t.width - t.fx, 1e-3)
    turn = np.array(Quaternion(np.roll(t.quaternion, 1).tolist()).to_matrix())
    c.measure("pose", "quaternion as w, x, y, z", turn - rotation(t.quaternion))

    bpy.ops.wm.read_factory_settings(use_empty=True)
    eye, body = link("eye", bpy.data.cameras.new("eye")), link("body", None)
    eye.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, "Y")
    bpy.context.view_layer.update()
    opengl = np.reshape(t.read("poses.json")["opengl"]["matrix"], (4, 4)).T
    body.matrix_world = eye.matrix_world @ Matrix(opengl.tolist())
    bpy.context.view_layer.update()
    inside = np.array(eye.matrix_world.inverted() @ body.matrix_world)
    c.points("pose", "toFrame(…, opengl) below the camera", apply(FLIP @ inside, t.points / 0.25), t.placed, 2e-6)
