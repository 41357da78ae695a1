/** An app that uses the package in one piece, with one more module that its bundler embeds. */
import { createAligner } from "sim3align/inline";
import joint from "sim3align/wasm/joint_bg.wasm";
import { show, work } from "./work.js";

show(work((options) => createAligner({ ...options, wasm: { joint } })));
