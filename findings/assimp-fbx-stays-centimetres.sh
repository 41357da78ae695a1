#!/usr/bin/env bash
# assimp: an FBX that Blender wrote becomes a glTF that is 100 times too large.
#
# One would expect: a converter from FBX, whose unit is the centimetre unless its header says otherwise, to glTF, which has metres
# only, keeps the size of the object. assimp does so for Collada, whose <unit> it applies.
#
# What happens: the numbers are kept. A body that is 17 cm long in Blender is written by Blender as 17 with UnitScaleFactor 1
# (centimetres), and assimp's glTF says 17: metres. Blender's own import of this glTF shows 17 m. No warning.
#
# Versions: assimpjs 0.0.10 (assimp 5), bpy 5.0.1, Node 20, Python 3.11.
#
# Why it matters: FBX is the usual file of shops and scanners, and GLB what aligners, viewers and robots read. A scale that is
# searched by depth finds 0.01 and hides it; a mesh whose size is taken as known is placed a hundred times too far away.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet bpy==5.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_cube_add(size=1)
bpy.context.object.scale = (0.17, 0.09, 0.05)
bpy.ops.object.transform_apply(scale=True)
bpy.ops.export_scene.fbx(filepath="body.fbx")
print(f"bpy {bpy.app.version_string}: wrote a body of {[round(each, 3) for each in bpy.context.object.dimensions]} m as FBX")
PYTHON
npm init --yes > npm.log
npm install --no-audit --no-fund assimpjs@0.0.10 >> npm.log
cat > convert.js <<'JS'
const { readFileSync } = require("node:fs");
require("assimpjs")().then((assimp) => {
  const files = new assimp.FileList();
  files.AddFile("body.fbx", readFileSync("body.fbx"));
  const glb = Buffer.from(assimp.ConvertFileList(files, "glb2").GetFile(0).GetContent());
  const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString());
  const { min, max } = json.accessors[json.meshes[0].primitives[0].attributes.POSITION];
  // The longest side, with the scales of the nodes above the mesh.
  const scales = json.nodes.map(({ matrix = [1], scale = [1] }) => Math.max(Math.hypot(...matrix.slice(0, 3)), scale[0]));
  const size = Math.max(...max.map((each, k) => each - min[k])) * scales.reduce((product, each) => product * each, 1);
  console.log(`assimpjs 0.0.10: the glTF of this FBX is ${size.toFixed(3)} m long`);
  if (Math.abs(size - 17) > 0.01) throw new Error("the behaviour has changed");
});
JS
node convert.js
