/** An app that uses the package in one piece. */
import { createAligner } from "sim3align/inline";
import { show, work } from "./work.js";

show(work(createAligner));
