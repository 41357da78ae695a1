/** npm packages that write meshes, and that load ours. Those that the repository does not have are in `target/interop/npm`. */
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join } from "node:path";
import { pathToFileURL } from "node:url";
import { at } from "../lib/paths.mjs";

const root = at("target", "interop");
const require = createRequire(join(root, "npm", "package.json"));
const source = (/** @type {string} */ name) => join(root, "truth", name);
/** @param {string} path @returns {Promise<any>} */
const load = (path) => import(path.startsWith("three") ? path : pathToFileURL(require.resolve(path)).href);
/** The known object: its points, triangles, and colours, sRGB and light. */
const truth = () => JSON.parse(readFileSync(source("truth.json"), "utf8"));

/**
 * A program writes a file, with what is expected of it as in `checks.py`, or loads one of ours and returns its points.
 * @typedef {object} Cells
 * @property {(variant: string, file: string, write: (path: string) => unknown, expect?: object) => Promise<void>} mesh
 * @property {(load: (path: string) => Promise<Iterable<number>>) => Promise<void>} glb
 */

/** @type {Record<string, { package: string, run: (cells: Cells) => Promise<void> }>} */
export const programs = {
  three: { package: "three", run: three },
  "Babylon.js": { package: "@babylonjs/core", run: babylon },
  assimp: { package: "assimpjs", run: assimp },
  obj2gltf: { package: "obj2gltf", run: obj2gltf },
  "splat-transform": { package: "@playcanvas/splat-transform", run: splatTransform },
  "glTF-Transform": { package: "@gltf-transform/cli", run: gltfTransform },
  gltfpack: { package: "gltfpack", run: gltfpack },
};

/** The folder of an installed package, and its version. @param {string} name */
function packageOf(name) {
  for (const folder of [at("node_modules", name), join(root, "npm", "node_modules", name)]) {
    try {
      return { folder, ...JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) };
    } catch {}
  }
  throw new Error(`${name} is not installed`);
}

/** Runs the command of a program. @param {string} program @param {string[]} args */
function command(program, args) {
  const { folder, bin } = packageOf(programs[program]?.package ?? program);
  const file = typeof bin === "string" ? bin : `${Object.values(bin)[0]}`;
  execFileSync(process.execPath, [join(folder, file), ...args], { stdio: "pipe" });
}

/**
 * The cells of a program of commands.
 * @param {string} program
 * @param {Cells} cells
 * @param {(input: string, output: string, ...options: string[]) => string[]} form the arguments of a command
 */
async function commands(program, { mesh }, form) {
  const { light, exact, commands } = JSON.parse(readFileSync(at("scripts", "interop", "commands.json"), "utf8"))[
    program
  ];
  for (const colors of ["vertex", "texture"]) {
    for (const options of commands.split("; ")) {
      const limits = { colors, colorLimit: 6, limitM: new RegExp(exact).test(options) ? 2e-7 : 2e-5 };
      // Floats of light become bytes of light there, which a file does not say.
      const isLight = colors === "vertex" && new RegExp(light).test(options);
      const expect = isLight ? { ...limits, options: { colorSpace: "linear" } } : limits;
      const file = options === "partition" ? "mesh.gltf" : "mesh.glb";
      const write = (/** @type {string} */ path) =>
        command(program, form(source(`${colors}.glb`), path, ...options.split(" ")));
      await mesh(`${options}, ${colors}`, file, write, expect);
    }
  }
}

/** @param {Cells} cells */
async function gltfpack(cells) {
  await commands("gltfpack", cells, (input, output, ...options) => ["-i", input, ...options, "-o", output]);
}

/** @param {Cells} cells */
async function gltfTransform(cells) {
  await commands("glTF-Transform", cells, (input, output, name = "", ...rest) => [name, input, output, ...rest]);
  const { NodeIO } = await import("@gltf-transform/core");
  const { transformMesh } = await import("@gltf-transform/functions");
  await cells.glb(async (path) => {
    const nodes = (await new NodeIO().read(path)).getRoot().listNodes();
    return nodes.flatMap((node) => {
      const mesh = node.getMesh();
      if (mesh === null) return [];
      transformMesh(mesh, node.getWorldMatrix());
      return mesh.listPrimitives().flatMap((each) => [...(each.getAttribute("POSITION")?.getArray() ?? [])]);
    });
  });
}

/** @param {Cells} cells */
async function three({ mesh, glb }) {
  // What its exporters and loaders need of a browser.
  Object.assign(globalThis, { self: globalThis, FileReader: FileReaderOfBlobs });
  const known = truth();
  const three = await load("three");
  const object = (/** @type {any} */ colors) => {
    const geometry = new three.BufferGeometry().setIndex(known.triangles.flat());
    geometry.setAttribute("position", new three.Float32BufferAttribute(known.points.flat(), 3));
    if (colors) geometry.setAttribute("color", colors);
    geometry.computeVertexNormals();
    return new three.Mesh(geometry, new three.MeshStandardMaterial({ vertexColors: Boolean(colors) }));
  };
  const plain = () => object(undefined);
  const printed = () => object(new three.Float32BufferAttribute(known.lights.flat(), 3));
  const bytes = () => {
    const levels = known.lights.flat().map((/** @type {number} */ each) => Math.round(255 * each));
    return object(new three.Uint8BufferAttribute(levels, 3, true));
  };
  const placed = () => {
    const inner = printed();
    const turn = new three.Matrix4().makeRotationFromQuaternion(new three.Quaternion(0.5, 0.5, 0.5, 0.5));
    turn.scale(new three.Vector3(2, 2, 2)).setPosition(1, 2, 3);
    inner.geometry.applyMatrix4(turn.clone().invert());
    inner.applyMatrix4(turn);
    const group = new three.Group().add(inner);
    group.updateMatrixWorld(true);
    return group;
  };
  const instances = () => {
    const all = new three.InstancedMesh(plain().geometry, new three.MeshStandardMaterial(), 1);
    all.setMatrixAt(0, new three.Matrix4());
    return all;
  };
  const vertex = { colors: "vertex" };
  const near = { ...vertex, limitM: 1e-6 };
  // The file does not say that these bytes are light.
  const light = { ...vertex, colorLimit: 3, options: { colorSpace: "linear" } };
  const binary = { binary: true };
  /** @type {[exporter: string, what: string, ending: string, make: () => any, options?: object, expect?: object][]} */
  const rows = [
    ["GLTFExporter", "GLB", "glb", printed, binary, vertex],
    ["GLTFExporter", "glTF", "gltf", printed, {}, vertex],
    ["GLTFExporter", "turned and scaled", "glb", placed, binary, near],
    ["GLTFExporter", "trs", "glb", placed, { ...binary, trs: true }, near],
    ["GLTFExporter", "InstancedMesh", "glb", instances, binary],
    ["GLTFExporter", "colours as bytes", "glb", bytes, binary, light],
    ["OBJExporter", "OBJ", "obj", printed, {}, vertex],
    ["OBJExporter", "turned and scaled", "obj", placed, {}, near],
    ["PLYExporter", "binary", "ply", printed, binary, vertex],
    ["PLYExporter", "text", "ply", printed, {}, vertex],
    ["PLYExporter", "little-endian, turned", "ply", placed, { ...binary, littleEndian: true }, near],
    ["STLExporter", "binary", "stl", plain, binary],
    ["STLExporter", "text", "stl", plain],
    ["USDZExporter", "USDZ", "usdz", plain, {}, { refused: "UNSUPPORTED_FORMAT", says: "USD" }],
  ];
  for (const [name, what, ending, make, options = {}, expect] of rows) {
    const write = async (/** @type {string} */ path) => {
      const exporter = new (await load(`three/examples/jsm/exporters/${name}.js`))[name]();
      const more = name === "PLYExporter" ? [undefined, options] : [options];
      const result = await (exporter.parseAsync?.(make(), options) ?? exporter.parse(make(), ...more));
      const bytes = result instanceof ArrayBuffer ? new Uint8Array(result) : result;
      writeFileSync(path, bytes.buffer || typeof bytes === "string" ? bytes : JSON.stringify(bytes));
    };
    await mesh(`${name}, ${what}`, `mesh.${ending}`, write, expect);
  }
  const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
  // Node has no pictures: textures are left out.
  const plugin = () => ({ name: "no pictures", loadTexture: async () => new three.Texture() });
  await glb(async (path) => {
    const { scene } = await new GLTFLoader().register(plugin).parseAsync(new Uint8Array(readFileSync(path)).buffer, "");
    scene.updateMatrixWorld(true);
    /** @type {number[]} */
    const points = [];
    scene.traverse((/** @type {any} */ { geometry, matrixWorld }) => {
      if (geometry) points.push(...geometry.applyMatrix4(matrixWorld).attributes.position.array);
    });
    return points;
  });
}

/** A part of the browser's class, for three.js. */
class FileReaderOfBlobs {
  onloadend() {}
  /** @param {Blob} blob */
  async readAsArrayBuffer(blob) {
    this.result = await blob.arrayBuffer();
    this.onloadend();
  }
  /** @param {Blob} blob */
  async readAsDataURL(blob) {
    this.result = `data:${blob.type};base64,${Buffer.from(await blob.arrayBuffer()).toString("base64")}`;
    this.onloadend();
  }
}

/** @param {Cells} cells */
async function babylon({ mesh, glb }) {
  const [core, serializers] = await Promise.all(["@babylonjs/core", "@babylonjs/serializers"].map(load));
  await load("@babylonjs/loaders/glTF/2.0");
  core.Logger.LogLevels = 0;
  const engine = new core.NullEngine();
  const known = truth();
  const data = {
    positions: known.points.flat(),
    // Its triangles turn the other way.
    indices: known.triangles.flatMap((/** @type {number[]} */ [a, b, c]) => [a, c, b]),
    colors: known.lights.flatMap((/** @type {number[]} */ light) => [...light, 1]),
  };
  for (const hand of ["right-handed", "left-handed"]) {
    const scene = new core.Scene(engine);
    scene.useRightHandedSystem = hand === "right-handed";
    const shape = new core.Mesh("body", scene);
    Object.assign(new core.VertexData(), data).applyToMesh(shape);
    shape.material = new core.PBRMaterial("print", scene);
    // A left-handed scene is mirrored, as it is shown; STL swaps two axes in both.
    const mirrored = scene.useRightHandedSystem ? {} : { axes: "-x" };
    const glb = async (/** @type {string} */ path) => {
      const { files } = await serializers.GLTF2Export.GLBAsync(scene, "mesh");
      writeFileSync(path, await files["mesh.glb"].bytes());
    };
    const obj = (/** @type {string} */ path) =>
      writeFileSync(path, serializers.OBJExport.OBJ([shape], false, undefined, true));
    const stl = (/** @type {string} */ path) =>
      writeFileSync(path, serializers.STLExport.CreateSTL([shape], false, "mesh", true, true));
    await mesh(`GLB, ${hand} scene`, "mesh.glb", glb, { colors: "vertex", ...mirrored });
    await mesh(`OBJ, ${hand} scene`, "mesh.obj", obj, mirrored);
    await mesh(`STL, ${hand} scene`, "mesh.stl", stl, { axes: "y and z swapped" });
  }
  await glb(async (path) => {
    const scene = new core.Scene(engine);
    scene.useRightHandedSystem = true;
    const url = `data:model/gltf-binary;base64,${readFileSync(path).toString("base64")}`;
    const pluginOptions = { gltf: { skipMaterials: true } };
    await core.AppendSceneAsync(url, scene, { pluginExtension: ".glb", pluginOptions });
    const meshes = scene.meshes.filter((/** @type {any} */ each) => each.getTotalVertices() > 0);
    return meshes.flatMap((/** @type {any} */ each) => [
      ...each.bakeCurrentTransformIntoVertices().getVerticesData("position"),
    ]);
  });
  engine.dispose();
}

/** @param {Cells} cells */
async function assimp({ mesh }) {
  const assimp = await require("assimpjs")();
  /** @type {[program: string, folder: string, file: string, expect?: object][]} */
  const rows = [
    ["trimesh-5.2.0", "mesh-dae", "mesh.dae"],
    ["trimesh-5.2.0", "mesh-3mf", "mesh.3mf"],
    ["trimesh-5.2.0", "mesh-off", "mesh.off"],
    ["trimesh-5.2.0", "mesh-obj-colours-of-vertices", "mesh.obj"],
    ["trimesh-5.2.0", "mesh-stl-plain", "mesh.stl"],
    ["PyMeshLab-2025.7.post1", "mesh-dae", "mesh.dae"],
    // Its numbers stay centimetres, which glTF does not have.
    ["Blender-5.0.1", "mesh-FBX", "mesh.fbx", { axes: "y-up", unit: 100, limitM: 2e-6 }],
  ];
  for (const [program, folder, file, expect] of rows) {
    for (const format of ["glb2", "gltf2"]) {
      const write = (/** @type {string} */ path) => {
        const files = new assimp.FileList();
        files.AddFile(file, readFileSync(join(root, "files", program, folder, file)));
        const result = assimp.ConvertFileList(files, format);
        if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
        for (let i = 0; i < result.FileCount(); i++) {
          const each = result.GetFile(i);
          writeFileSync(i === 0 ? path : join(dirname(path), basename(each.GetPath())), each.GetContent());
        }
      };
      const variant = `${format} of the ${file.slice(5).toUpperCase()} of ${program}`;
      await mesh(variant, `mesh.${format.slice(0, -1)}`, write, { limitM: 1e-6, ...expect });
    }
  }
}

/** @param {Cells} cells */
async function obj2gltf({ mesh }) {
  const convert = require(`${"obj2gltf"}`);
  const obj = join(root, "files", "trimesh-5.2.0", "mesh-obj-texture-PBR-material-", "mesh.obj");
  const binary = (/** @type {object} */ options) => async (/** @type {string} */ path) =>
    writeFileSync(path, await convert(obj, { binary: true, ...options }));
  const separate = async (/** @type {string} */ path) => {
    const writer = (/** @type {string} */ name, /** @type {Buffer} */ data) =>
      writeFileSync(join(dirname(path), basename(name)), data);
    writeFileSync(path, JSON.stringify(await convert(obj, { separate: true, writer })));
  };
  await mesh("GLB", "mesh.glb", binary({}), { colors: "texture" });
  await mesh("GLB, inputUpAxis Z", "mesh.glb", binary({ inputUpAxis: "Z" }), { colors: "texture", axes: "y-up" });
  await mesh("glTF, separate", "mesh.gltf", separate, { colors: "texture" });
}

/** @param {Cells} cells */
async function splatTransform({ mesh }) {
  const formats = { sog: "splat-transform", spz: "splat-transform", csv: "", glb: "Gaussians" };
  for (const [format, says] of Object.entries(formats)) {
    const args = ["-w", "-g", "cpu", at("tests", "fixtures", "splat.ply")];
    const write = (/** @type {string} */ path) => command("splat-transform", [...args, path]);
    await mesh(format, `mesh.${format}`, write, { refused: "UNSUPPORTED_FORMAT", says });
  }
}

/** All that a program writes and loads, a row for each; what it loaded is in files as `read.mjs` writes them. @param {string} name */
export async function rowsOf(name) {
  const program = programs[name];
  if (program === undefined) throw new Error(`${name} is no program`);
  const { version } = packageOf(program.package);
  /** @type {any[]} */
  const rows = [];
  const fileOf = (/** @type {string} */ variant, /** @type {string} */ file) => {
    const folder = join(root, "files", `${name}-${version}`, variant.replace(/\W+/g, "-"));
    mkdirSync(folder, { recursive: true });
    return join(folder, file);
  };
  await program.run({
    async mesh(variant, base, write, expect = {}) {
      const file = fileOf(variant, base);
      const row = { program: name, version, action: "write", kind: "mesh", variant, file };
      try {
        await write(file);
        rows.push({ ...row, expect });
      } catch (error) {
        const { message, stderr } = /** @type {any} */ (error);
        rows.push({ ...row, notWritten: `${stderr || message}`.slice(0, 300) });
      }
    },
    async glb(load) {
      for (const each of ["node", "baked", "textured", "scene-camera", "node-opencv"]) {
        const read = fileOf(each, "loaded.json");
        const loaded = await load(join(root, "ours", `${each}.glb`))
          .then((positions) => ({ positions: [...positions] }))
          .catch((error) => ({ code: "none", message: `${error}` }));
        writeFileSync(read, JSON.stringify(loaded));
        const expect = { frame: each === "node-opencv" ? "opencv" : "opengl" };
        rows.push({ program: name, version, action: "load", kind: "GLB", variant: `${each}.glb`, read, expect });
      }
    },
  });
  return rows;
}
