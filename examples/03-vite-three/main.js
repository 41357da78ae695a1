import { createAligner } from "sim3align";
import { readDepth, readMask } from "sim3align/formats";
import { applyPinhole, applyToObject3D, meshInputFromThree } from "sim3align/three";
import {
  AmbientLight,
  Color,
  DirectionalLight,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { depthCloud } from "./depth-cloud.js";

const query = (selector) => document.querySelector(selector);
const status = query("#status");

try {
  await show(`${import.meta.env.BASE_URL}mug/`);
} catch (error) {
  status.textContent = String(error);
  status.dataset.state = "failed";
}

/** @param {string} folder */
async function show(folder) {
  const fetched = async (name) => {
    const response = await fetch(folder + name);
    if (!response.ok) throw new Error(`${folder}${name}: ${response.status}`);
    return response;
  };
  const blob = async (name) => (await fetched(name)).blob();
  const [depth, mask, pinhole, { scene: object }] = await Promise.all([
    blob("depth.npy").then((file) => readDepth(file)),
    blob("mask.png").then((file) => readMask(file)),
    fetched("camera.json").then((response) => response.json()),
    new GLTFLoader().loadAsync(`${folder}mesh.glb`),
  ]);

  status.textContent = "Aligning …";
  const aligner = await createAligner({ workers: 1 });
  const result = await aligner.align({ depth, mask, cameraFile: pinhole, mesh: meshInputFromThree(object) });
  aligner.dispose();

  // A camera at the origin with the intrinsics of the depth camera, and the object in front of it.
  const { width, height } = depth;
  const camera = new PerspectiveCamera();
  applyPinhole(camera, pinhole, { width, height });
  applyToObject3D(object, result);
  object.traverse((part) => {
    if (part instanceof Mesh) part.material = new MeshLambertMaterial({ color: 0xff7a1a });
  });
  const cloud = depthCloud(depth, mask, pinhole);
  const light = new DirectionalLight(0xffffff, 2);
  light.position.set(-1, 1, 1);
  const scene = new Scene().add(object, cloud, light, new AmbientLight(0xffffff, 1.5));
  scene.background = new Color(0x101418);

  const renderer = new WebGLRenderer({ canvas: query("#view"), antialias: true });
  renderer.setSize(width, height, false);
  const render = () => renderer.render(scene, camera);
  const controls = new OrbitControls(camera, renderer.domElement);
  // Orbit about a point straight ahead, at the distance of the object: the initial view is that of the depth camera.
  controls.target.set(0, 0, -result.translation[2]);
  controls.update();
  controls.addEventListener("change", render);
  query("#cloud").addEventListener("change", ({ target }) => {
    cloud.visible = target.checked;
    render();
  });
  render();

  const confidence = result.confidence.toFixed(2);
  status.textContent = `Aligned: 1 mesh unit is ${result.scale.toFixed(3)} m, confidence ${confidence}.`;
  status.dataset.state = "done";
}
