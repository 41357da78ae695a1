/** What any runtime prints: what comes of the package as it is, and in one piece. */
import { createAligner } from "sim3align";
import { createAligner as createInline } from "sim3align/inline";
import { work } from "./work.js";

console.log(JSON.stringify([await work(createAligner), await work(createInline)]));
