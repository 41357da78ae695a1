/** A program for every runtime: prints the results of both entries of the package. */
import { createAligner } from "sim3align";
import { createAligner as createInline } from "sim3align/inline";
import { work } from "./work.js";

console.log(JSON.stringify([await work(createAligner), await work(createInline)]));
