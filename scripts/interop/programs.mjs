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

/** The folder of an installed package, and its version. @param {string} name */
function packageOf(name) {
  for (const folder of [at("node_modules", name), join(root, "npm", "node_modules", name)]) {
    try {
      return { folder, ...JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) };
    } catch {}
  }
  throw new Error(`${name} is not installed`);
}

/** Runs the command of an npm package. @param {string} name @param {string[]} args */
function command(name, args) {
  const { folder, bin } = packageOf(name);
  const file = typeof bin === "string" ? bin : `${Object.values(bin)[0]}`;
  execFileSync(process.execPath, [join(folder, file), ...args], { stdio: "pipe" });
}

/** The arrays of the known body; colours are light. */
function body() {
  const known = JSON.parse(readFileSync(source("truth.json"), "utf8"));
  const light = (/** @type {number} */ byte) =>
    byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
  return {
    positions: Float32Array.from(known.points.flat()),
    indices: Uint32Array.from(known.triangles.flat()),
    lights: Float32Array.from(known.colors.flat(), light),
  };
}

/**
 * What a program does with files: writes one (what is expected of it as in `checks.py`), or loads one of ours: its points.
 * @typedef {object} Cells
 * @property {(variant: string, file: string, write: (path: string) => unknown, expect?: object) => Promise<void>} mesh
 * @property {(load: (path: string) => Promise<ArrayLike<number>>) => Promise<void>} glb
 */

/** @type {Record<string, { package: string, run: (cells: Cells) => Promise<void> }>} */
export const programs = {
  three: { package: "three", run: three },
  "Babylon.js": { package: "@babylonjs/core", run: babylon },
  assimp: { package: "assimpjs", run: assimp },
  obj2gltf: { package: "obj2gltf", run: obj2gltf },
  "splat-transform": { package: "@playcanvas/splat-transform", run: splatTransform },
};

/** @type {Record<string, { package: string, form: string, light: string, exact: string, commands: string }>} */
const commands = JSON.parse(readFileSync(at("scripts", "interop", "commands.json"), "utf8"));
for (const [name, { package: distribution, form, light, exact, commands: list }] of Object.entries(commands)) {
  const run = async (/** @type {Cells} */ { mesh, glb }) => {
    for (const colors of ["vertex", "texture"]) {
      for (const options of list.split("; ")) {
        // Floats of light become bytes of light there, which a file does not say.
        const isLight = colors === "vertex" && new RegExp(light).test(options);
        const isExact = new RegExp(exact).test(options);
        const expect = {
          colors,
          colorLimit: 6,
          limitM: isExact ? 2e-7 : 2e-5,
          ...(isLight ? { options: { colorSpace: "linear" } } : {}),
        };
        const file = options === "partition" ? "mesh.gltf" : "mesh.glb";
        await mesh(
          `${options}, ${colors}`,
          file,
          (path) => {
            const [first = "", ...rest] = options.split(" ");
            const words = {
              COMMAND: [first],
              OPTIONS: form.startsWith("COMMAND") ? rest : [first, ...rest],
              IN: [source(`${colors}.glb`)],
              OUT: [path],
            };
            command(
              distribution,
              form.split(" ").flatMap((word) => words[/** @type {"IN"} */ (word)] ?? [word]),
            );
          },
          expect,
        );
      }
    }
    if (name === "glTF-Transform") await glb(pointsOfDocument);
  };
  programs[name] = { package: distribution, run };
}

/** @param {string} path */
async function pointsOfDocument(path) {
  const { NodeIO } = await import("@gltf-transform/core");
  const { Matrix4, Vector3 } = await load("three");
  const nodes = (await new NodeIO().read(path)).getRoot().listNodes();
  return nodes.flatMap((node) => {
    const matrix = new Matrix4().fromArray(node.getWorldMatrix());
    const all =
      node
        .getMesh()
        ?.listPrimitives()
        .flatMap((each) => Array.from(each.getAttribute("POSITION")?.getArray() ?? [])) ?? [];
    return all.flatMap((_, i) => (i % 3 === 0 ? new Vector3().fromArray(all, i).applyMatrix4(matrix).toArray() : []));
  });
}

/** @param {Cells} cells */
async function three({ mesh, glb }) {
  // What its exporters and loaders need of a browser.
  Object.assign(globalThis, { self: globalThis, FileReader: FileReaderOfBlobs });
  const { positions, indices, lights } = body();
  const three = await load("three");
  const attribute = (/** @type {any} */ array, normalised = false) =>
    new three.BufferAttribute(array.slice(), array === indices ? 1 : 3, normalised);
  const object = (/** @type {any} */ colors) => {
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", attribute(positions));
    if (colors) geometry.setAttribute("color", attribute(colors, colors instanceof Uint8Array));
    geometry.setIndex(attribute(indices)).computeVertexNormals();
    return new three.Mesh(geometry, new three.MeshStandardMaterial({ vertexColors: Boolean(colors) }));
  };
  const plain = () => object(undefined);
  const printed = () => object(lights);
  const bytes = () => object(Uint8Array.from(lights, (each) => Math.round(255 * each)));
  const placed = () => {
    const inner = printed();
    const turn = new three.Matrix4().compose(
      new three.Vector3(1, 2, 3),
      new three.Quaternion(0.5, 0.5, 0.5, 0.5),
      new three.Vector3(2, 2, 2),
    );
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
  const [vertex, near] = [{ colors: "vertex" }, { colors: "vertex", limitM: 1e-6 }];
  const binary = { binary: true };
  /** @type {[exporter: string, what: string, file: string, make: () => any, options?: object, expect?: object][]} */
  const rows = [
    ["GLTFExporter", "GLB", "mesh.glb", printed, binary, vertex],
    ["GLTFExporter", "glTF", "mesh.gltf", printed, {}, vertex],
    ["GLTFExporter", "turned and scaled", "mesh.glb", placed, binary, near],
    ["GLTFExporter", "trs", "mesh.glb", placed, { ...binary, trs: true }, near],
    ["GLTFExporter", "InstancedMesh", "mesh.glb", instances, binary],
    // The file does not say that these bytes are light.
    [
      "GLTFExporter",
      "colours as bytes",
      "mesh.glb",
      bytes,
      binary,
      { ...vertex, colorLimit: 3, options: { colorSpace: "linear" } },
    ],
    ["OBJExporter", "OBJ", "mesh.obj", printed, {}, vertex],
    ["OBJExporter", "turned and scaled", "mesh.obj", placed, {}, near],
    ["PLYExporter", "binary", "mesh.ply", printed, binary, vertex],
    ["PLYExporter", "text", "mesh.ply", printed, {}, vertex],
    ["PLYExporter", "little-endian, turned", "mesh.ply", placed, { ...binary, littleEndian: true }, near],
    ["STLExporter", "binary", "mesh.stl", plain, binary],
    ["STLExporter", "text", "mesh.stl", plain],
    ["USDZExporter", "USDZ", "mesh.usdz", plain, {}, { refused: "UNSUPPORTED_FORMAT", says: "USD" }],
  ];
  for (const [name, what, file, make, options = {}, expect] of rows) {
    await mesh(
      `${name}, ${what}`,
      file,
      async (path) => {
        const exporter = new (await load(`three/examples/jsm/exporters/${name}.js`))[name]();
        const result = await (exporter.parseAsync?.(make(), options) ??
          exporter.parse(make(), ...(name === "PLYExporter" ? [undefined] : []), options));
        const bytes = result instanceof ArrayBuffer ? new Uint8Array(result) : result;
        writeFileSync(path, bytes.buffer || typeof bytes === "string" ? bytes : JSON.stringify(bytes));
      },
      expect,
    );
  }
  const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
  await glb(async (path) => {
    const bytes = readFileSync(path);
    // Node has no pictures: textures are left out.
    const loader = new GLTFLoader().register(() => ({
      name: "no pictures",
      loadTexture: async () => new three.Texture(),
    }));
    const { scene } = await loader.parseAsync(
      bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length),
      "",
    );
    scene.updateMatrixWorld(true);
    /** @type {number[]} */
    const points = [];
    scene.traverse((/** @type {any} */ { geometry, matrixWorld }) => {
      for (let i = 0; i < (geometry?.attributes.position.count ?? 0); i++) {
        points.push(
          ...new three.Vector3().fromBufferAttribute(geometry.attributes.position, i).applyMatrix4(matrixWorld),
        );
      }
    });
    return points;
  });
}

/** A part of the browser's class, for three.js. */
class FileReaderOfBlobs {
  onloadend() {}
  /** @param {Blob} blob */
  readAsArrayBuffer(blob) {
    blob.arrayBuffer().then((result) => Object.assign(this, { result }).onloadend());
  }
  /** @param {Blob} blob */
  readAsDataURL(blob) {
    const url = (/** @type {ArrayBuffer} */ bytes) =>
      `data:${blob.type};base64,${Buffer.from(bytes).toString("base64")}`;
    blob.arrayBuffer().then((bytes) => Object.assign(this, { result: url(bytes) }).onloadend());
  }
}

/** @param {Cells} cells */
async function babylon({ mesh, glb }) {
  const [core, serializers] = await Promise.all(["@babylonjs/core", "@babylonjs/serializers"].map(load));
  await load("@babylonjs/loaders/glTF/2.0");
  core.Logger.LogLevels = 0;
  const engine = new core.NullEngine();
  const { positions, indices, lights } = body();
  for (const right of [true, false]) {
    const scene = new core.Scene(engine);
    scene.useRightHandedSystem = right;
    const shape = new core.Mesh("body", scene);
    // Its triangles turn the other way.
    const turned = Array.from(indices, (_, i) => indices[i - (i % 3) + ((3 - (i % 3)) % 3)]);
    const colors = Array.from({ length: (4 * lights.length) / 3 }, (_, i) =>
      i % 4 === 3 ? 1 : lights[3 * Math.floor(i / 4) + (i % 4)],
    );
    Object.assign(new core.VertexData(), { positions, indices: turned, colors }).applyToMesh(shape);
    shape.material = new core.PBRMaterial("print", scene);
    const hand = right ? "right-handed" : "left-handed";
    // A left-handed scene is mirrored, as it is shown; STL swaps two axes in both.
    const mirrored = right ? {} : { axes: "-x" };
    await mesh(
      `GLB, ${hand} scene`,
      "mesh.glb",
      async (path) => {
        const { files } = await serializers.GLTF2Export.GLBAsync(scene, "mesh");
        writeFileSync(path, new Uint8Array(await files["mesh.glb"].arrayBuffer()));
      },
      { colors: "vertex", ...mirrored },
    );
    await mesh(
      `OBJ, ${hand} scene`,
      "mesh.obj",
      (path) => writeFileSync(path, serializers.OBJExport.OBJ([shape], false, undefined, true)),
      mirrored,
    );
    const stl = () => new Uint8Array(serializers.STLExport.CreateSTL([shape], false, "mesh", true, true).buffer);
    await mesh(`STL, ${hand} scene`, "mesh.stl", (path) => writeFileSync(path, stl()), { axes: "y and z swapped" });
  }
  await glb(async (path) => {
    const scene = new core.Scene(engine);
    scene.useRightHandedSystem = true;
    const url = `data:model/gltf-binary;base64,${readFileSync(path).toString("base64")}`;
    await core.AppendSceneAsync(url, scene, {
      pluginExtension: ".glb",
      pluginOptions: { gltf: { skipMaterials: true } },
    });
    const meshes = scene.meshes.filter((/** @type {any} */ each) => each.getTotalVertices() > 0);
    return meshes.flatMap((/** @type {any} */ each) => {
      const places = each.getVerticesData("position");
      const at = (/** @type {number} */ i) =>
        core.Vector3.TransformCoordinates(
          core.Vector3.FromArray(places, 3 * i),
          each.computeWorldMatrix(true),
        ).asArray();
      return Array.from({ length: places.length / 3 }, (_, i) => at(i)).flat();
    });
  });
  engine.dispose();
}

/** @param {Cells} cells */
async function assimp({ mesh }) {
  const assimp = await require("assimpjs")();
  const [trimesh, lab, blender] = ["trimesh-5.2.0", "PyMeshLab-2025.7.post1", "Blender-5.0.1"];
  /** @type {[program: string, folder: string, file: string, expect?: object][]} */
  const rows = [
    [trimesh, "mesh-dae", "mesh.dae"],
    [trimesh, "mesh-3mf", "mesh.3mf"],
    [trimesh, "mesh-off", "mesh.off"],
    [trimesh, "mesh-obj-colours-of-vertices", "mesh.obj"],
    [trimesh, "mesh-stl-plain", "mesh.stl"],
    [lab, "mesh-dae", "mesh.dae"],
    // Its numbers stay centimetres, which glTF does not have.
    [blender, "mesh-FBX", "mesh.fbx", { axes: "y-up", unit: 100, limitM: 2e-6 }],
  ];
  for (const [program, folder, file, expect] of rows) {
    for (const format of ["glb2", "gltf2"]) {
      await mesh(
        `${format} of the ${file.slice(5).toUpperCase()} of ${program}`,
        `mesh.${format.slice(0, -1)}`,
        (path) => {
          const files = new assimp.FileList();
          files.AddFile(file, readFileSync(join(root, "files", program, folder, file)));
          const result = assimp.ConvertFileList(files, format);
          if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
          for (let i = 0; i < result.FileCount(); i++) {
            const each = result.GetFile(i);
            writeFileSync(i === 0 ? path : join(dirname(path), basename(each.GetPath())), each.GetContent());
          }
        },
        { limitM: 1e-6, ...expect },
      );
    }
  }
}

/** @param {Cells} cells */
async function obj2gltf({ mesh }) {
  const convert = require(`${"obj2gltf"}`);
  const obj = join(root, "files", "trimesh-5.2.0", "mesh-obj-texture-PBR-material-", "mesh.obj");
  const binary = (/** @type {object} */ options) => async (/** @type {string} */ path) =>
    writeFileSync(path, await convert(obj, { binary: true, ...options }));
  await mesh("GLB", "mesh.glb", binary({}), { colors: "texture" });
  await mesh("GLB, inputUpAxis Z", "mesh.glb", binary({ inputUpAxis: "Z" }), { colors: "texture", axes: "y-up" });
  await mesh(
    "glTF, separate",
    "mesh.gltf",
    async (path) => {
      const writer = (/** @type {string} */ name, /** @type {Buffer} */ data) =>
        writeFileSync(join(dirname(path), basename(name)), data);
      writeFileSync(path, JSON.stringify(await convert(obj, { separate: true, writer })));
    },
    { colors: "texture" },
  );
}

/** @param {Cells} cells */
async function splatTransform({ mesh }) {
  for (const [format, says] of [
    ["sog", "splat-transform"],
    ["spz", "splat-transform"],
    ["csv", ""],
    ["glb", "Gaussians"],
  ]) {
    const args = ["-w", "-g", "cpu", at("tests", "fixtures", "splat.ply")];
    await mesh(`${format}`, `mesh.${format}`, (path) => command("@playcanvas/splat-transform", [...args, path]), {
      refused: "UNSUPPORTED_FORMAT",
      says,
    });
  }
}

/** All that a program writes and loads, a row for each; what it loaded is in files as `read.mjs` writes them. @param {string} name */
export async function rowsOf(name) {
  const program = programs[name];
  if (program === undefined) throw new Error(`${name} is no program`);
  const { version } = packageOf(program.package);
  /** @type {any[]} */
  const rows = [];
  const folderOf = (/** @type {string} */ variant) => {
    const folder = join(root, "files", `${name}-${version}`, variant.replace(/\W+/g, "-"));
    mkdirSync(folder, { recursive: true });
    return folder;
  };
  await program.run({
    async mesh(variant, file, write, expect = {}) {
      const row = {
        program: name,
        version,
        action: "write",
        kind: "mesh",
        variant,
        file: join(folderOf(variant), file),
      };
      try {
        await write(row.file);
        rows.push({ ...row, expect });
      } catch (error) {
        const { message, stderr } = /** @type {any} */ (error);
        rows.push({ ...row, notWritten: `${stderr || message}`.slice(0, 300) });
      }
    },
    async glb(load) {
      for (const variant of ["node", "baked", "textured", "scene-camera", "node-opencv"]) {
        const read = join(folderOf(variant), "loaded.json");
        const loaded = await load(join(root, "ours", `${variant}.glb`))
          .then((positions) => ({ positions: Array.from(positions) }))
          .catch((error) => ({ code: "none", message: `${error}` }));
        writeFileSync(read, JSON.stringify(loaded));
        rows.push({
          program: name,
          version,
          action: "load",
          kind: "GLB",
          variant: `${variant}.glb`,
          read,
          expect: { frame: variant === "node-opencv" ? "opencv" : "opengl" },
        });
      }
    },
  });
  return rows;
}
