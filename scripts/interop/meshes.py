"""Programs that write meshes: the known body in each of their formats."""

import os

import numpy as np

from .cells import program

# Converted by another program first, as our error says.
REFUSED = {"refused": "UNSUPPORTED_FORMAT"}
VERTEX, TEXTURE, FACE = ({"colors": each} for each in ("vertex", "texture", "face"))
# A quarter turn about x: z up becomes y up.
YUP = {"axes": "y-up"}


@program("trimesh")
def trimesh_(c, t):
    import trimesh
    from PIL import Image

    def body(visual=None):
        return trimesh.Trimesh(t.points, t.triangles, process=False, visual=visual)

    plain = body()
    rgba = np.concatenate([t.colors, np.full((len(t.colors), 1), 255, np.uint8)], 1)
    printed = body(trimesh.visual.ColorVisuals(vertex_colors=rgba))
    faces = body(trimesh.visual.ColorVisuals(face_colors=np.c_[t.face_colors, np.full(len(t.face_colors), 255)]))
    image = Image.open(t.texture)
    simple = body(trimesh.visual.TextureVisuals(uv=t.uv, image=image))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0)
    pbr = body(trimesh.visual.TextureVisuals(uv=t.uv, material=material))
    for format in ("glb", "gltf", "obj", "ply", "stl"):
        c.write("mesh", f"{format} plain", f"mesh.{format}", plain.export)
    c.write("mesh", "STL, text", "mesh.stl", lambda p: plain.export(p, file_type="stl_ascii"))
    c.write("mesh", "PLY, text", "mesh.ply", lambda p: printed.export(p, encoding="ascii"), **VERTEX)
    for format in ("glb", "gltf", "obj", "ply"):
        c.write("mesh", f"{format}, colours of vertices", f"mesh.{format}", printed.export, **VERTEX)
    for format in ("glb", "ply"):
        c.write("mesh", f"{format}, colours of faces", f"mesh.{format}", faces.export, **FACE)
    for name, mesh in (("simple", simple), ("PBR", pbr)):
        for format in ("glb", "gltf", "obj", "ply"):
            # Without the name of the picture, a PLY has coordinates of a texture only.
            expect = {"warns": "texture"} if format == "ply" else TEXTURE
            if name == "simple" and format.startswith("gl"):
                # The grey of a default material, 0.4, becomes a factor of the texture in glTF.
                expect = {"colors": "texture", "colorFactor": 0.4}
            c.write("mesh", f"{format}, texture ({name} material)", f"mesh.{format}", mesh.export, **expect)

    def placed(matrix):
        scene = trimesh.Scene()
        inner = body(printed.visual.copy())
        inner.apply_transform(np.linalg.inv(matrix))
        scene.add_geometry(inner, transform=matrix)
        return scene

    turn = trimesh.transformations.rotation_matrix(1.0, [1, 2, 3], [0.1, 0.2, 0.3])
    for name, matrix in (
        ("node in millimetres", np.diag([0.001, 0.001, 0.001, 1])),
        ("turned node", turn),
        ("node with three scales", turn @ np.diag([0.5, 2, 3, 1])),
        ("mirrored node", np.diag([-1.0, 1, 1, 1])),
    ):
        # Of a mirrored body its own inside is out before the node mirrors it back.
        c.write("mesh", f"glb, {name}", "mesh.glb", placed(matrix).export, limitM=2e-6, **VERTEX)
    halves = trimesh.Scene([body().submesh([np.arange(128)])[0], body().submesh([np.arange(128, 256)])[0]])
    for format in ("glb", "obj", "ply", "stl"):
        c.write("mesh", f"{format}, scene of two parts", f"mesh.{format}", halves.export)
    for format in ("off", "dae", "3mf"):
        c.write("mesh", format, f"mesh.{format}", plain.export, **REFUSED)


@program("Open3D", distribution="open3d")
def open3d_(c, t):
    import open3d as o3d

    def body(kind="vertex"):
        mesh = o3d.geometry.TriangleMesh(
            o3d.utility.Vector3dVector(t.points), o3d.utility.Vector3iVector(t.triangles)
        )
        if kind == "vertex":
            mesh.vertex_colors = o3d.utility.Vector3dVector(t.colors / 255.0)
        if kind == "texture":
            mesh.triangle_uvs = o3d.utility.Vector2dVector(t.uv[t.triangles].reshape(-1, 2))
            # Open3D keeps textures from the bottom up, and turns them round when it reads and writes files.
            mesh.textures = [o3d.geometry.Image(np.ascontiguousarray(np.asarray(o3d.io.read_image(t.texture))[::-1]))]
            mesh.triangle_material_ids = o3d.utility.IntVector([0] * len(t.triangles))
        mesh.compute_vertex_normals()
        return mesh

    def save(kind, **options):
        def write(path):
            assert o3d.io.write_triangle_mesh(path, body(kind), **options), "refused"

        return write

    for format in ("glb", "gltf", "obj", "ply"):
        c.write("mesh", f"{format}, colours of vertices", f"mesh.{format}", save("vertex"), **VERTEX)
    c.write("mesh", "ply, text", "mesh.ply", save("vertex", write_ascii=True), **VERTEX)
    c.write("mesh", "ply, compressed=True", "mesh.ply", save("vertex", compressed=True), **VERTEX)
    c.write("mesh", "stl", "mesh.stl", save("plain"))
    c.write("mesh", "obj, texture", "mesh.obj", save("texture"), **TEXTURE)
    # Its GLB has neither the texture nor its coordinates.
    c.write("mesh", "glb, texture", "mesh.glb", save("texture"))
    c.write("mesh", "off", "mesh.off", save("plain"), **REFUSED)

    def tensor(path):
        mesh = o3d.t.geometry.TriangleMesh.from_legacy(body())
        assert o3d.t.io.write_triangle_mesh(path, mesh), "refused"

    for format in ("glb", "obj", "ply", "stl"):
        c.write("mesh", f"{format}, tensor", f"mesh.{format}", tensor, **({} if format == "stl" else VERTEX))


@program("PyMeshLab", distribution="pymeshlab")
def pymeshlab_(c, t):
    import pymeshlab

    rgba = np.c_[t.colors / 255.0, np.ones(len(t.colors))]
    face = np.c_[t.face_colors / 255.0, np.ones(len(t.face_colors))]

    def save(kind, **options):
        def write(path):
            meshes = pymeshlab.MeshSet()
            colors = {"vertex": {"v_color_matrix": rgba}, "face": {"f_color_matrix": face}}.get(kind, {})
            meshes.add_mesh(pymeshlab.Mesh(t.points, t.triangles, **colors), "body")
            meshes.save_current_mesh(path, **options)

        return write

    c.write("mesh", "ply", "mesh.ply", save("vertex"), **VERTEX)
    c.write("mesh", "ply, text", "mesh.ply", save("vertex", binary=False), **VERTEX)
    c.write("mesh", "ply, colours of faces", "mesh.ply", save("face", save_face_color=True, save_vertex_color=False), **FACE)
    c.write("mesh", "obj", "mesh.obj", save("vertex", save_vertex_color=True), **VERTEX)
    c.write("mesh", "obj, colours of faces", "mesh.obj", save("face", save_face_color=True, save_vertex_color=False), **FACE)
    c.write("mesh", "stl", "mesh.stl", save("plain"))
    c.write("mesh", "stl, colours of faces", "mesh.stl", save("face", save_face_color=True), colors="face", colorLimit=14)
    c.write("mesh", "stl, text", "mesh.stl", save("plain", binary=False))
    for format in ("off", "3mf", "dae", "wrl", "x3d", "ctm"):
        c.write("mesh", format, f"mesh.{format}", save("plain"), **REFUSED)


@program("meshio")
def meshio_(c, t):
    import meshio

    plain = meshio.Mesh(t.points, [("triangle", t.triangles)])
    red, green, blue = t.colors.T
    printed = meshio.Mesh(
        t.points, [("triangle", t.triangles)], point_data={"red": red, "green": green, "blue": blue}
    )
    c.write("mesh", "obj", "mesh.obj", lambda p: meshio.write(p, plain))
    c.write("mesh", "ply", "mesh.ply", lambda p: meshio.write(p, printed), **VERTEX)
    c.write("mesh", "ply, text", "mesh.ply", lambda p: meshio.write(p, printed, binary=False), **VERTEX)
    c.write("mesh", "stl", "mesh.stl", lambda p: meshio.write(p, plain, binary=True))
    c.write("mesh", "stl, text", "mesh.stl", lambda p: meshio.write(p, plain, binary=False))
    for format in ("off", "vtk", "vtu"):
        c.write("mesh", format, f"mesh.{format}", lambda p: meshio.write(p, plain), **REFUSED)


@program("plyfile")
def plyfile_(c, t):
    from plyfile import PlyData, PlyElement

    def save(text=False, order="<", number="f4", wide="u1", faces="i4"):
        def write(path):
            names = [(axis, number) for axis in "xyz"] + [(each, wide) for each in ("red", "green", "blue")]
            # 16-bit colours have the whole range, floats 0 to 1.
            factor = {"u1": 1, "u2": 257, "f4": 1 / 255.0}[wide]
            rows = [tuple(p) + tuple(each * factor for each in color) for p, color in zip(t.points, t.colors.astype(int))]
            vertex = PlyElement.describe(np.array(rows, dtype=names), "vertex")
            face = np.empty(len(t.triangles), dtype=[("vertex_indices", faces, (3,))])
            face["vertex_indices"] = t.triangles
            described = PlyElement.describe(face, "face", len_types={"vertex_indices": "u1"})
            PlyData([vertex, described], text=text, byte_order=order).write(path)

        return write

    c.write("mesh", "ply", "mesh.ply", save(), **VERTEX)
    c.write("mesh", "ply, text", "mesh.ply", save(text=True), **VERTEX)
    c.write("mesh", "ply, big-endian", "mesh.ply", save(order=">"), **VERTEX)
    c.write("mesh", "ply, doubles", "mesh.ply", save(number="f8", faces="u4"), **VERTEX)
    c.write("mesh", "ply, colours of 16 bits", "mesh.ply", save(wide="u2"), **VERTEX)
    c.write("mesh", "ply, colours as floats", "mesh.ply", save(wide="f4"), **VERTEX)


@program("numpy-stl")
def numpy_stl(c, t):
    from stl import Mode, mesh

    body = mesh.Mesh(np.zeros(len(t.triangles), dtype=mesh.Mesh.dtype))
    body.vectors[:] = t.points[t.triangles]
    c.write("mesh", "stl", "mesh.stl", lambda p: body.save(p, mode=Mode.BINARY))
    c.write("mesh", "stl, text", "mesh.stl", lambda p: body.save(p, mode=Mode.ASCII), limitM=1e-6)


@program("scikit-image", distribution="scikit-image")
def skimage_(c, t):
    import skimage.io

    c.write("depth", "png of millimetres", "depth.png", lambda p: skimage.io.imsave(p, t.mm, check_contrast=False), limitM=0.0005001)
    c.write("depth", "tiff of metres", "depth.tiff", lambda p: skimage.io.imsave(p, t.depth, check_contrast=False))
    c.write("mask", "png of booleans", "mask.png", lambda p: skimage.io.imsave(p, t.mask > 0, check_contrast=False))


@program("usd-core")
def usd_(c, t):
    from pxr import Usd, UsdGeom, UsdUtils

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

    for format in ("usda", "usdc"):
        c.write("mesh", format, f"mesh.{format}", save, refused="UNSUPPORTED_FORMAT", says="USD")
    c.write("mesh", "usdz", "mesh.usdz", pack, refused="UNSUPPORTED_FORMAT", says="USD")


@program("Blender", distribution="bpy")
def blender_(c, t):
    import bpy

    def scene(kind, parent=False):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        data = bpy.data.meshes.new("body")
        data.from_pydata(t.points.tolist(), [], t.triangles.tolist())
        body = bpy.data.objects.new("body", data)
        bpy.context.collection.objects.link(body)
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
            above = bpy.data.objects.new("above", None)
            bpy.context.collection.objects.link(above)
            above.scale, above.rotation_euler = (0.01,) * 3, (0.3, 0.4, 0.5)
            bpy.context.view_layer.update()
            body.parent, body.matrix_parent_inverse = above, above.matrix_world.inverted()
        bpy.context.view_layer.objects.active = body
        body.select_set(True)

    def save(operator, kind="plain", parent=False, **options):
        def write(path):
            scene(kind, parent)
            folder, name = operator.split(".")
            getattr(getattr(bpy.ops, folder), name)(filepath=path, **options)

        return write

    glb, obj, ply, stl = "export_scene.gltf", "wm.obj_export", "wm.ply_export", "wm.stl_export"
    for kind in ("BYTE_COLOR", "FLOAT_COLOR"):
        for format, name in (("GLB", "mesh.glb"), ("GLTF_SEPARATE", "mesh.gltf")):
            c.write("mesh", f"{format}, {kind}", name, save(glb, kind, export_format=format), **YUP, **VERTEX)
    c.write("mesh", "GLB, texture", "mesh.glb", save(glb, "texture"), **YUP, **TEXTURE)
    c.write("mesh", "glTF, texture", "mesh.gltf", save(glb, "texture", export_format="GLTF_SEPARATE"), **YUP, **TEXTURE)
    jpeg = {"export_image_format": "JPEG"}
    c.write("mesh", "GLB, JPEG", "mesh.glb", save(glb, "texture", **jpeg), **YUP, colors="texture", colorLimit=6)
    webp = {"export_image_format": "WEBP"}
    c.write("mesh", "GLB, WebP", "mesh.glb", save(glb, "texture", **webp), **YUP, colors="texture", colorLimit=6)
    c.write("mesh", "GLB, z up", "mesh.glb", save(glb, "FLOAT_COLOR", export_yup=False), **VERTEX)
    c.write("mesh", "GLB below a scaled empty", "mesh.glb", save(glb, "FLOAT_COLOR", True), limitM=1e-6, **YUP, **VERTEX)
    draco = {"export_draco_mesh_compression_enable": True, "export_draco_position_quantization": 16}
    c.write("mesh", "GLB, Draco", "mesh.glb", save(glb, "FLOAT_COLOR", **draco), limitM=1e-5, colorLimit=6, **YUP, **VERTEX)
    c.write("mesh", "OBJ", "mesh.obj", save(obj), **YUP)
    c.write("mesh", "OBJ, colours of vertices", "mesh.obj", save(obj, "FLOAT_COLOR", export_colors=True), **YUP, **VERTEX)
    c.write("mesh", "OBJ, texture", "mesh.obj", save(obj, "texture", path_mode="COPY"), **YUP, **TEXTURE)
    c.write("mesh", "OBJ, z up", "mesh.obj", save(obj, forward_axis="Y", up_axis="Z"))
    c.write("mesh", "OBJ in millimetres", "mesh.obj", save(obj, global_scale=1000.0), unit=1000, **YUP)
    c.write("mesh", "PLY", "mesh.ply", save(ply))
    for kind in ("BYTE_COLOR", "FLOAT_COLOR"):
        colors = {"export_colors": "SRGB"}
        c.write("mesh", f"PLY, {kind}", "mesh.ply", save(ply, kind, **colors), **VERTEX)
        c.write("mesh", f"PLY, text, {kind}", "mesh.ply", save(ply, kind, ascii_format=True, **colors), **VERTEX)
    c.write("mesh", "STL", "mesh.stl", save(stl))
    c.write("mesh", "STL, text", "mesh.stl", save(stl, ascii_format=True), limitM=1e-6)
    c.write("mesh", "FBX", "mesh.fbx", save("export_scene.fbx"), refused="UNSUPPORTED_FORMAT", says="FBX")
    c.write("mesh", "USD", "mesh.usdc", save("wm.usd_export"), refused="UNSUPPORTED_FORMAT", says="USD")

