/** A program for every runtime: prints the results of both entries of the package. */
import { readFile } from "node:fs/promises";
import { createAligner } from "sim3align";
import { createAligner as createInline } from "sim3align/inline";
import { work } from "./work.js";

const joint = await readFile(new URL("../../node_modules/sim3align/wasm/joint_bg.wasm", import.meta.url));
const inline = (options = {}) => createInline({ ...options, wasm: { joint } });
console.log(JSON.stringify([await work(createAligner), await work(inline)]));
