/** An app that draws with three.js, and has the element beside its own view. */
import type { Sim3AlignElement } from "sim3align/element/shared";
import { WebGPURenderer } from "three/webgpu";
import { input } from "../support/scene.js";
import "sim3align/element/shared";

const { mask, mesh, ...view } = input;
const element = document.createElement("sim3-align") as Sim3AlignElement;
element.style.blockSize = "30rem";
element.scene = { ...view, name: "Blob", objects: [{ name: "blob", mask, mesh }] };
document.body.append(element, new WebGPURenderer({ forceWebGL: true }).domElement);
