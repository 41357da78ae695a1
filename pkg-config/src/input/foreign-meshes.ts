/** Files of meshes and 3D Gaussians that are not read: what they are, and how to convert them. */

const latin = (bytes: Uint8Array) => new TextDecoder("latin1").decode(bytes);

/** Bytes at the beginning and at the end of a file that tell its format; the names in a ZIP archive are at its end. */
const LOOKED_AT = 65_536;

const splats = (name: string) => `Convert it: npx @playcanvas/splat-transform ${name} out.ply.`;
const assimp = (name: string) =>
  `Convert it with assimp, which keeps its unit and axes: assimp export ${name} out.glb -fglb2.`;
const trimesh = (name: string, more = "") =>
  `Convert it with trimesh (pip install trimesh${more}): python -c "import trimesh; trimesh.load('${name}').export('out.glb')".`;
const blender = "Open it in Blender and export it as GLB.";

/** By how a file begins; in archives, by the names in them. Of "latin1", runtimes make ISO 8859-1 or Windows-1252. */
const formats: readonly (readonly [beginning: RegExp, found: string, remedy: string])[] = [
  [/^NGSP/, "3D Gaussians as SPZ", splats("in.spz")],
  [
    /^[^ -~][\u008b\u2039]/,
    "a gzip stream, as of 3D Gaussians in an .spz",
    `${splats("in.spz")} If it is another file, unpack it.`,
  ],
  [/^PK[\s\S]*means_l\./, "3D Gaussians as SOG", splats("in.sog")],
  [
    /^(glTF|\s*\{)[\s\S]*KHR_gaussian_splatting/,
    "3D Gaussians in a glTF file",
    "Export them as PLY from the program that made them: splat-transform does not read this form.",
  ],
  [/^PK[\s\S]*3D\/3dmodel\.model/, "a 3MF file", trimesh("in.3mf", " lxml networkx")],
  [/^(PK[\s\S]*\.usd[ac]?|#usda|PXR-USDC)/, "a USD file", blender],
  [/^PK[^ -~]/, "a ZIP archive", "Unpack it, and pass the mesh in it."],
  [/^\s*<\?xml[\s\S]*<COLLADA|^\s*<COLLADA/, "a COLLADA file (DAE)", assimp("in.dae")],
  [/^\s*<\?xml[\s\S]*<X3D|^\s*<X3D|^#VRML/, "an X3D or VRML file", assimp("in.x3d")],
  [/^\s*<\?xml[\s\S]*<amf/, "an AMF file", assimp("in.amf")],
  [/^\s*(ST|C|N|4|n)*OFF\b/, "an OFF file", trimesh("in.off")],
  [/^\s*ISO-10303-21/, "a STEP file", trimesh("in.step", " cascadio")],
  [/^(Kaydara FBX|; FBX)/, "an FBX scene", blender],
  [/^(BLENDER|\x28\xb5\x2f\xfd)/, "a Blender file", blender],
  [/^(# \.PCD|VERSION \.7)/, "a point cloud (PCD)", "A point cloud can't be rendered: mesh it first."],
  [
    /^# vtk DataFile|^<VTKFile/,
    "a VTK file",
    "Convert it with meshio (pip install meshio): meshio convert in.vtk out.obj.",
  ],
  [/^\$MeshFormat/, "a mesh of Gmsh", "Convert it with meshio (pip install meshio): meshio convert in.msh out.obj."],
  [/^version https:\/\/git-lfs/, "a pointer of Git LFS, which stands for the file", "Fetch the file: git lfs pull."],
  [
    /^\s*<(!DOCTYPE html|html)/i,
    "an HTML page",
    "The server sent a page in place of the file: check its address, and response.ok.",
  ],
  [/^ply[\s\S]*packed_position/, "compressed 3D Gaussians of SuperSplat", splats("in.compressed.ply")],
];

/** What a file is that is not read; `undefined` for any other. */
export function foreignMesh(bytes: Uint8Array): { found: string; remedy: string } | undefined {
  const text = latin(bytes.subarray(0, LOOKED_AT)) + latin(bytes.subarray(-LOOKED_AT));
  const known = formats.find(([beginning]) => beginning.test(text));
  return known && { found: known[1], remedy: known[2] };
}
