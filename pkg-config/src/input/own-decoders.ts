/** The decoders of compressed geometry that the package carries. */
import type { MeshDecoders } from "./mesh-decoders.js";

// As `compressed-gltf.ts`, this file imports nothing.

/**
 * The decoders that a glTF file with this JSON needs, and that the caller lacks. One that cannot be loaded is missing: the reader
 * names the compression and the ways out.
 * @param dracoModule compiles the WebAssembly module of Draco
 */
export async function ownDecoders(
  json: string,
  given: MeshDecoders,
  dracoModule: () => Promise<object>,
): Promise<MeshDecoders> {
  const [meshoptDecoder, dracoDecoder] = await Promise.all([
    json.includes("_meshopt_") && !given.meshoptDecoder ? meshopt().catch(() => undefined) : undefined,
    json.includes("_draco_") && !given.dracoDecoder ? draco(dracoModule()).catch(() => undefined) : undefined,
  ]);
  return { meshoptDecoder, dracoDecoder };
}

const meshopt = async () => (await import("../wasm/meshopt.js")).MeshoptDecoder;

async function draco(compiled: Promise<object>) {
  const [{ default: create }, module] = await Promise.all([import("../wasm/draco.js"), compiled]);
  return new Promise<Awaited<ReturnType<typeof create>>>((resolve, reject) => {
    const instantiateWasm = (imports: object, done: (instance: object) => void) => {
      const { instantiate } = WebAssembly;
      instantiate(module as WebAssembly.Module, imports as WebAssembly.Imports).then(done, reject);
      return {};
    };
    create({ instantiateWasm }).then(resolve, reject);
  });
}
