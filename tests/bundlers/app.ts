/** An app that uses the package as it is. */
import { createAligner } from "sim3align";
import { show, work } from "./work.js";

show(work(createAligner));
