// Draws the README's picture: what the camera saw, the mesh, and the mesh where it is.
import { createAligner } from "sim3align";
import { maskBox, orientedBoundingBox } from "sim3align/conventions.js";
import { readDepth, readMask } from "sim3align/formats.js";
import { applyToObject3D, cameraFromPinhole, meshInputFromThree } from "sim3align/three.js";
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const folder = "/target/samples/mug/";
const [width, height] = [300, 225];
const fetched = async (name) => (await fetch(folder + name)).blob();
const [depth, mask, pinhole, { scene: object }] = await Promise.all([
  fetched("depth.npy").then((file) => readDepth(file)),
  fetched("mask.png").then((file) => readMask(file)),
  fetch(`${folder}camera.json`).then((response) => response.json()),
  new GLTFLoader().loadAsync(`${folder}mesh.glb`),
]);
const mesh = meshInputFromThree(object);
const aligner = await createAligner();
const result = await aligner.align({ depth, mask, camera: pinhole, mesh });

drawDepth(document.querySelector("#seen"));
object.traverse((part) => {
  if (part.isMesh) part.material = new THREE.MeshLambertMaterial({ color: 0xf08030, side: THREE.DoubleSide });
});
drawMesh(document.querySelector("#generated"));
drawPlaced(document.querySelector("#placed"));
const [wide, high, deep] = orientedBoundingBox(mesh, result, { box: "minimal" }).sizeM.map((metres) =>
  (100 * metres).toFixed(1),
);
const sure = `confidence ${result.confidence.toFixed(2)}`;
document.querySelector("#answer").textContent = `in its place: ${wide} × ${high} × ${deep} cm, ${sure}`;
document.body.dataset.state = "done";

/** Few steps of brightness, so that the file stays small. */
function shade(z) {
  const [near, far] = [0.45, 1.35];
  return Math.round(24 * Math.min(1, Math.max(0, (far - z) / (far - near)))) / 24;
}

/** The part about the object. */
function drawDepth(canvas) {
  const { left, top } = maskBox(mask, { marginPx: 75 });
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(depth.width, depth.height);
  const isInside = (u, v) => mask.data[v * depth.width + u] === 1;
  depth.data.forEach((z, i) => {
    const [u, v] = [i % depth.width, Math.floor(i / depth.width)];
    const bright = z > 0 ? 40 + 200 * shade(z) : 16;
    const isRim = isInside(u, v) && [-1, 1].some((step) => !isInside(u + step, v) || !isInside(u, v + step));
    const colour = isRim ? [255, 255, 255] : isInside(u, v) ? [0.25, 0.75, 1] : [0.75, 0.8, 0.9];
    pixels.data.set([...(isRim ? colour : colour.map((c) => c * bright)), 255], 4 * i);
  });
  context.putImageData(pixels, -left, -top);
}

function render(canvas, camera, ...objects) {
  const light = new THREE.DirectionalLight(0xffffff, 2.2);
  light.position.set(-1, 2, 2);
  camera.add(light);
  const scene = new THREE.Scene().add(camera, new THREE.AmbientLight(0xffffff, 1), ...objects);
  scene.background = new THREE.Color(0x1b2028);
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(2);
  renderer.setSize(width, height, false);
  renderer.render(scene, camera);
}

function drawMesh(canvas) {
  const box = new THREE.Box3().setFromObject(object);
  const { center, radius } = box.getBoundingSphere(new THREE.Sphere());
  const camera = new THREE.PerspectiveCamera(35, width / height, radius / 10, 10 * radius);
  camera.position.copy(center).addScaledVector(new THREE.Vector3(0.5, 0.6, 1).normalize(), 3.8 * radius);
  camera.lookAt(center);
  render(canvas, camera, object, new THREE.Box3Helper(box, 0x68727e));
}

function drawPlaced(canvas) {
  applyToObject3D(object, result);
  const cloud = pointsOf();
  const { fov } = cameraFromPinhole(pinhole, depth);
  // From beside the camera, so that both are seen to be in space.
  const camera = new THREE.PerspectiveCamera(0.4 * fov, width / height, 0.01, 10);
  const centre = new THREE.Box3().setFromObject(object).getCenter(new THREE.Vector3());
  camera.position.set(-0.28, 0.2, 0);
  camera.lookAt(centre);
  render(canvas, camera, object, cloud);
}

function pointsOf() {
  const [positions, colours] = [[], []];
  depth.data.forEach((z, i) => {
    const [u, v] = [i % depth.width, Math.floor(i / depth.width)];
    if (!(z > 0) || u % 2 || v % 2) return;
    positions.push(((u - pinhole.cx) * z) / pinhole.fx, (-(v - pinhole.cy) * z) / pinhole.fy, -z);
    const colour = mask.data[i] ? [0.1, 0.5, 0.9] : [0.06, 0.075, 0.1];
    colours.push(...colour.map((c) => c * (0.4 + shade(z))));
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  return new THREE.Points(geometry, new THREE.PointsMaterial({ size: 3, sizeAttenuation: false, vertexColors: true }));
}
