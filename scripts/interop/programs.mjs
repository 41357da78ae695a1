/** npm packages that write meshes, and that load ours. Those that the repository does not have are in `target/interop/npm`. */
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join } from "node:path";
import { pathToFileURL } from "node:url";
import { at } from "../lib/paths.mjs";
import { fileOf, root } from "./cells.mjs";

/** @typedef {import("./cells.mjs").Cells} Cells */

const require = createRequire(join(root, "npm", "package.json"));
/** @param {string} path @returns {Promise<any>} */
const load = (path) => import(path.startsWith("three") ? path : pathToFileURL(require.resolve(path)).href);
const truth = (/** @type {string} */ name) => join(root, "truth", name);
/** The known object: its points, triangles, and its colours as light. */
const known = () => JSON.parse(readFileSync(truth("truth.json"), "utf8"));

/** The folder of an installed package, and its version. @param {string} name */
export function packageOf(name) {
  for (const folder of [at("node_modules", name), join(root, "npm", "node_modules", name)]) {
    try {
      return { folder, ...JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) };
    } catch {}
  }
  throw new Error(`${name} is not installed`);
}

/** @type {Record<string, { package: string, run: (cells: Cells, name: string) => Promise<void> }>} */
export const programs = {
  three: { package: "three", run: three },
  "Babylon.js": { package: "@babylonjs/core", run: babylon },
  assimp: { package: "assimpjs", run: assimp },
  obj2gltf: { package: "obj2gltf", run: commands },
  "splat-transform": { package: "@playcanvas/splat-transform", run: commands },
  "glTF-Transform": { package: "@gltf-transform/cli", run: gltfTransform },
  gltfpack: { package: "gltfpack", run: commands },
};

/** Commands convert the known object in a GLB, splats, or what another program wrote. @param {Cells} cells @param {string} name */
async function commands({ writes }, name) {
  const { folder, bin } = packageOf(name);
  const program = join(folder, typeof bin === "string" ? bin : `${Object.values(bin)[0]}`);
  /** @type {Record<string, string>} */
  const sources = {
    vertex: truth("vertex.glb"),
    texture: truth("texture.glb"),
    splats: at("tests", "fixtures", "splat.ply"),
  };
  await writes({
    command(output, _, words, source) {
      /** @type {Record<string, string>} */
      const paths = { $input: sources[source] ?? fileOf(source).file, $output: output };
      const args = words.split(" ").map((/** @type {string} */ word) => paths[word] ?? word);
      execFileSync(process.execPath, [program, ...args], { stdio: "pipe" });
    },
  });
}

/** @param {Cells} cells @param {string} name */
async function gltfTransform(cells, name) {
  await commands(cells, name);
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
async function three({ writes, glb }) {
  // What its exporters and loaders need of a browser.
  Object.assign(globalThis, { self: globalThis, FileReader: FileReaderOfBlobs });
  const three = await load("three");
  const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
  /** The objects in a file. Node has no pictures: textures are left out. @param {string} path @returns {Promise<any[]>} */
  const objectsIn = async (path) => {
    const plugin = () => ({ name: "no pictures", loadTexture: async () => new three.Texture() });
    const { scene } = await new GLTFLoader().register(plugin).parseAsync(new Uint8Array(readFileSync(path)).buffer, "");
    scene.updateMatrixWorld(true);
    /** @type {any[]} */
    const objects = [];
    scene.traverse((/** @type {any} */ each) => each.geometry && objects.push(each));
    return objects;
  };

  /** The objects to export, each made from the one with vertex colours. @type {Record<string, (printed: any) => any>} */
  const forms = {
    printed: (printed) => printed,
    plain: ({ geometry }) => new three.Mesh(geometry.deleteAttribute("color"), new three.MeshStandardMaterial()),
    bytes(printed) {
      const { color } = printed.geometry.attributes;
      const levels = Array.from(color.array, (each) => Math.round(255 * each));
      printed.geometry.setAttribute("color", new three.Uint8BufferAttribute(levels, color.itemSize, true));
      return printed;
    },
    placed(printed) {
      const turn = new three.Matrix4().makeRotationFromQuaternion(new three.Quaternion(0.5, 0.5, 0.5, 0.5));
      turn.scale(new three.Vector3(2, 2, 2)).setPosition(1, 2, 3);
      printed.geometry.applyMatrix4(turn.clone().invert());
      printed.applyMatrix4(turn);
      const group = new three.Group().add(printed);
      group.updateMatrixWorld(true);
      return group;
    },
    instances({ geometry }) {
      const all = new three.InstancedMesh(geometry.deleteAttribute("color"), new three.MeshStandardMaterial(), 1);
      all.setMatrixAt(0, new three.Matrix4());
      return all;
    },
  };
  await writes({
    async exporter(path, options, name, form) {
      const [printed] = await objectsIn(truth("vertex.glb"));
      const made = forms[form]?.(printed);
      const exporter = new (await load(`three/examples/jsm/exporters/${name}.js`))[name]();
      const more = name === "PLYExporter" ? [undefined, options] : [options];
      const result = await (exporter.parseAsync?.(made, options) ?? exporter.parse(made, ...more));
      const bytes = result instanceof ArrayBuffer ? new Uint8Array(result) : result;
      writeFileSync(path, bytes.buffer || typeof bytes === "string" ? bytes : JSON.stringify(bytes));
    },
  });
  await glb(async (path) => {
    const objects = await objectsIn(path);
    return objects.flatMap(({ geometry, matrixWorld }) => [
      ...geometry.applyMatrix4(matrixWorld).attributes.position.array,
    ]);
  });
}

/** @param {Cells} cells */
async function babylon({ writes, glb }) {
  const [core, serializers] = await Promise.all(["@babylonjs/core", "@babylonjs/serializers"].map(load));
  await load("@babylonjs/loaders/glTF/2.0");
  core.Logger.LogLevels = 0;
  const engine = new core.NullEngine();
  const { points, triangles, lights } = known();
  const shapeIn = (/** @type {string} */ hand) => {
    const scene = new core.Scene(engine);
    scene.useRightHandedSystem = hand === "right-handed";
    const shape = new core.Mesh("body", scene);
    const data = new core.VertexData();
    data.positions = points.flat();
    // Its triangles turn the other way.
    data.indices = triangles.flatMap((/** @type {number[]} */ [a, b, c]) => [a, c, b]);
    data.colors = lights.flatMap((/** @type {number[]} */ light) => [...light, 1]);
    data.applyToMesh(shape);
    shape.material = new core.PBRMaterial("print", scene);
    return shape;
  };
  await writes({
    async glb(path, _, hand) {
      const { files } = await serializers.GLTF2Export.GLBAsync(shapeIn(hand).getScene(), "mesh");
      writeFileSync(path, await files["mesh.glb"].bytes());
    },
    obj: (path, _, hand) => writeFileSync(path, serializers.OBJExport.OBJ([shapeIn(hand)], false, undefined, true)),
    stl: (path, _, hand) =>
      writeFileSync(path, serializers.STLExport.CreateSTL([shapeIn(hand)], false, "mesh", true, true)),
  });
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
async function assimp({ writes }) {
  const assimp = await require("assimpjs")();
  await writes({
    convert(path, _, format, title) {
      const { file } = fileOf(title);
      const files = new assimp.FileList();
      files.AddFile(basename(file), readFileSync(file));
      const result = assimp.ConvertFileList(files, format);
      if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
      for (let i = 0; i < result.FileCount(); i++) {
        const each = result.GetFile(i);
        writeFileSync(i === 0 ? path : join(dirname(path), basename(each.GetPath())), each.GetContent());
      }
    },
  });
}
