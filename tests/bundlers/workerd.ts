/** What Cloudflare's runtime prints: what comes of the package where nothing can be fetched, read nor compiled. */
import { createAligner, Sim3AlignError } from "sim3align";
import core from "sim3align/wasm/core_bg.wasm";
import formats from "sim3align/wasm/formats_bg.wasm";
import joint from "sim3align/wasm/joint_bg.wasm";
import registration from "sim3align/wasm/registration_bg.wasm";
import { work } from "./work.js";

export default {
  /** Run by `workerd test`. */
  async test() {
    const wasm = { core, formats, joint, registration };
    const found = await work((options) => createAligner({ ...options, wasm }), [0]);
    const withWorkers = createAligner({ wasm, workers: 1 });
    const code = await withWorkers.catch((error: unknown) => error instanceof Sim3AlignError && error.code);
    console.log(JSON.stringify({ found, code }));
  },
};
