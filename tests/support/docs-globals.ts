/** The types of the globals that the documentation's examples use. */
import type { createAligner as create } from "sim3align";
import type { docsScene } from "./docs-scene.js";

type Scene = typeof docsScene;

declare global {
  var createAligner: typeof create;
  var aligner: Scene["aligner"];
  var input: Scene["input"];
  var depth: Scene["depth"];
  var width: number;
  var height: number;
  var mask: Scene["mask"];
  var camera: Scene["camera"];
  var fx: number;
  var fy: number;
  var cx: number;
  var cy: number;
  var photo: Scene["photo"];
  var relative: Scene["relative"];
  var mesh: Scene["mesh"];
  var glb: Scene["glb"];
  var result: Scene["result"];
  var truth: Scene["truth"];
  var scale: number;
  var rotation: Scene["rotation"];
  var translation: Scene["translation"];
  var x: number;
  var y: number;
  var z: number;
  var w: number;
  var object3d: Scene["object3d"];
  var threeCamera: Scene["threeCamera"];
}
