/** What Cloudflare's runtime prints: what comes of the package where nothing can be fetched, read nor compiled. */
import { createAligner, Sim3AlignError } from "sim3align";
import wasm from "sim3align/wasm/core_bg.wasm";
import formatsWasm from "sim3align/wasm/formats_bg.wasm";
import jointWasm from "sim3align/wasm/joint_bg.wasm";
import registrationWasm from "sim3align/wasm/registration_bg.wasm";
import { work } from "./work.js";

export default {
  /** Run by `workerd test`. */
  async test() {
    const modules = { wasm, formatsWasm, jointWasm, registrationWasm };
    const found = await work((options) => createAligner({ ...options, ...modules }), [0]);
    const withWorkers = createAligner({ wasm, workers: 1 });
    const code = await withWorkers.catch((error: unknown) => error instanceof Sim3AlignError && error.code);
    console.log(JSON.stringify({ found, code }));
  },
};
