/** The decoders of compressed geometry that the package carries, beside the glue of the modules: scripts of npm packages. */
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { glueDir } from "./paths.mjs";

/** The npm packages, whose licences the notice has. */
export const decoderPackages = ["draco3d", "meshoptimizer"];

const { resolve } = createRequire(import.meta.url);

/** Writes them with their declarations. */
export function writeDecoders() {
  mkdirSync(glueDir, { recursive: true });
  const file = (/** @type {string} */ name) => join(glueDir, name);
  copyFileSync(resolve("meshoptimizer/decoder"), file("meshopt.js"));
  const ofInput = (/** @type {string} */ type) => `import type { ${type} } from "../input/mesh-decoders.js";\n`;
  writeFileSync(
    file("meshopt.d.ts"),
    `${ofInput("MeshoptDecoder")}export declare const MeshoptDecoder: MeshoptDecoder;\n`,
  );
  // A script that reads files in Node or in pages, by what it finds in the realm. With its module it needs neither.
  const script = readFileSync(resolve("draco3d/draco_decoder_nodejs.js"), "utf8");
  const realm = "Object.create(globalThis, { process: {}, window: {}, WorkerGlobalScope: {} })";
  const whole = `export default ((globalThis, module, exports, require) => {\n${script}\nreturn module.exports;\n})(${realm}, { exports: {} }, {});\n`;
  writeFileSync(file("draco.js"), whole);
  const settings = "instantiateWasm(imports: object, done: (instance: object) => void): object";
  writeFileSync(
    file("draco.d.ts"),
    `${ofInput("DracoDecoderModule")}declare const create: (settings: { ${settings} }) => Promise<DracoDecoderModule>;\nexport default create;\n`,
  );
  copyFileSync(resolve("draco3d/draco_decoder.wasm"), file("draco_bg.wasm"));
}
