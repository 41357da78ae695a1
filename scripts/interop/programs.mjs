/** npm packages that write meshes, and that load ours. Those that the repository does not have are in `target/interop/npm`. */
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { at } from "../lib/paths.mjs";
import { root } from "./cells.mjs";

/** @typedef {import("./cells.mjs").Program} Program */

const require = createRequire(join(root, "npm", "package.json"));
/** @param {string} path @returns {Promise<any>} */
const load = (path) => import(path.startsWith("three") ? path : pathToFileURL(require.resolve(path)).href);

/** The folder of an installed package, and its version. @param {string} name */
export function packageOf(name) {
  for (const folder of [at("node_modules", name), join(root, "npm", "node_modules", name)]) {
    try {
      return { folder, ...JSON.parse(readFileSync(join(folder, "package.json"), "utf8")) };
    } catch {}
  }
  throw new Error(`${name} is not installed`);
}

/** @type {Record<string, { from: string, open: (from: string) => Promise<Program> }>} */
export const programs = {
  three: { from: "three", open: three },
  "Babylon.js": { from: "@babylonjs/core", open: babylon },
  assimp: { from: "assimpjs", open: assimp },
  obj2gltf: { from: "obj2gltf", open: command },
  "splat-transform": { from: "@playcanvas/splat-transform", open: command },
  "glTF-Transform": { from: "@gltf-transform/cli", open: gltfTransform },
  gltfpack: { from: "gltfpack", open: command },
};

/** A command converts a file: `$input` and `$output` among its words. @param {string} name @returns {Promise<Program>} */
async function command(name) {
  const { folder, bin } = packageOf(name);
  const program = join(folder, typeof bin === "string" ? bin : `${Object.values(bin)[0]}`);
  return {
    writers: {
      command(output, words, input) {
        const paths = new Map([
          ["$input", resolve(root, input)],
          ["$output", output],
        ]);
        const args = words.split(" ").map((/** @type {string} */ word) => paths.get(word) ?? word);
        execFileSync(process.execPath, [program, ...args], { stdio: "pipe" });
      },
    },
  };
}

/** @param {string} name @returns {Promise<Program>} */
async function gltfTransform(name) {
  const { NodeIO } = await import("@gltf-transform/core");
  const { transformMesh } = await import("@gltf-transform/functions");
  const glb = async (/** @type {string} */ path) => {
    const nodes = (await new NodeIO().read(path)).getRoot().listNodes();
    return nodes.flatMap((node) => {
      const mesh = node.getMesh();
      if (mesh === null) return [];
      transformMesh(mesh, node.getWorldMatrix());
      return mesh.listPrimitives().flatMap((each) => [...(each.getAttribute("POSITION")?.getArray() ?? [])]);
    });
  };
  return { ...(await command(name)), glb };
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

/** @returns {Promise<Program>} */
async function three() {
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
  return {
    writers: {
      async exporter(path, name, form, { options } = { options: {} }) {
        const [printed] = await objectsIn(join(root, "truth", "vertex.glb"));
        const made = forms[form]?.(printed);
        const exporter = new (await load(`three/examples/jsm/exporters/${name}.js`))[name]();
        const more = name === "PLYExporter" ? [undefined, options] : [options];
        const result = await (exporter.parseAsync?.(made, options) ?? exporter.parse(made, ...more));
        const bytes = result instanceof ArrayBuffer ? new Uint8Array(result) : result;
        writeFileSync(path, bytes.buffer || typeof bytes === "string" ? bytes : JSON.stringify(bytes));
      },
    },
    async glb(path) {
      const objects = await objectsIn(path);
      return objects.flatMap(({ geometry, matrixWorld }) => [
        ...geometry.applyMatrix4(matrixWorld).attributes.position.array,
      ]);
    },
  };
}

/** @returns {Promise<Program>} */
async function babylon() {
  const [core, serializers] = await Promise.all(["@babylonjs/core", "@babylonjs/serializers"].map(load));
  await load("@babylonjs/loaders/glTF/2.0");
  core.Logger.LogLevels = 0;
  const engine = new core.NullEngine();
  const { points, triangles, lights } = JSON.parse(readFileSync(join(root, "truth", "truth.json"), "utf8"));
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
  const { GLTF2Export, OBJExport, STLExport } = serializers;
  return {
    writers: {
      async glb(path, hand) {
        const { files } = await GLTF2Export.GLBAsync(shapeIn(hand).getScene(), "mesh");
        writeFileSync(path, await files["mesh.glb"].bytes());
      },
      obj: (path, hand) => writeFileSync(path, OBJExport.OBJ([shapeIn(hand)], false, undefined, true)),
      stl: (path, hand) => writeFileSync(path, STLExport.CreateSTL([shapeIn(hand)], false, "mesh", true, true)),
    },
    async glb(path) {
      const scene = new core.Scene(engine);
      scene.useRightHandedSystem = true;
      const url = `data:model/gltf-binary;base64,${readFileSync(path).toString("base64")}`;
      const pluginOptions = { gltf: { skipMaterials: true } };
      await core.AppendSceneAsync(url, scene, { pluginExtension: ".glb", pluginOptions });
      const meshes = scene.meshes.filter((/** @type {any} */ each) => each.getTotalVertices() > 0);
      return meshes.flatMap((/** @type {any} */ each) => [
        ...each.bakeCurrentTransformIntoVertices().getVerticesData("position"),
      ]);
    },
  };
}

/** @returns {Promise<Program>} */
async function assimp() {
  const assimp = await require("assimpjs")();
  return {
    writers: {
      convert(path, format, source) {
        const files = new assimp.FileList();
        files.AddFile(basename(source), readFileSync(source));
        const result = assimp.ConvertFileList(files, format);
        if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
        for (let i = 0; i < result.FileCount(); i++) {
          const each = result.GetFile(i);
          writeFileSync(i === 0 ? path : join(dirname(path), basename(each.GetPath())), each.GetContent());
        }
      },
    },
  };
}
