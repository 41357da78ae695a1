/** Runs in the page of the tests of the 3D view. esbuild bundles it with the view. */
import { exportGlb } from "sim3align/conventions";
import { BoxGeometry } from "three";
import { SceneView } from "../../www/src/view3d/scene-view.ts";

const [width, height] = [160, 120];
/** An off-centre principal point, and non-square pixels. */
const camera = { fx: 190, fy: 170, cx: 70, cy: 66 };
/** Colours of the quarters of the photo, row-major from the top left. */
const quarters = [
  [200, 40, 40],
  [40, 60, 200],
  [220, 200, 30],
  [120, 120, 120],
];
/** The scene is a wall at this distance, metres. */
const wallM = 1;
/** Bounds of the mask: first and last column, first and last row. */
const maskBox = [90, 130, 70, 100];

const scene = () => ({
  ...{ width, height, camera, depthM: new Float32Array(width * height).fill(wallM) },
  rgba: Uint8ClampedArray.from({ length: 4 * width * height }, (_, i) => {
    const [u, v] = [(i >> 2) % width, Math.floor((i >> 2) / width)];
    return quarters[(v < height / 2 ? 0 : 2) + (u < width / 2 ? 0 : 1)][i % 4] ?? 255;
  }),
});

const mask = () =>
  Uint8Array.from({ length: width * height }, (_, i) => {
    const [u, v] = [i % width, Math.floor(i / width)];
    return u >= maskBox[0] && u < maskBox[1] && v >= maskBox[2] && v < maskBox[3] ? 1 : 0;
  });

/** A cube around a point. */
function cube([x, y, z], side = 1) {
  const { attributes, index } = new BoxGeometry(side, side, side).translate(x, y, z);
  return { positions: Float32Array.from(attributes.position.array), indices: Uint32Array.from(index.array) };
}

/** A cube around (3, 0, 0): as arrays, or as a GLB whose node translates and scales it; or the GLB of these bytes. */
function mesh(kind) {
  if (typeof kind !== "string") return { glb: Uint8Array.from(kind) };
  if (kind === "arrays") return cube([3, 0, 0]);
  if (kind === "broken") return { glb: new TextEncoder().encode("glTF, but not really") };
  const moved = { scale: 2, rotation: [0, 0, 0, 1], translation: [1, 0, 0] };
  return { glb: exportGlb(cube([1, 0, 0], 0.5), moved, { frame: "opencv" }) };
}

const object = (id, colour, kind = "arrays") => ({ id, colour, mask: mask(), mesh: mesh(kind) });

globalThis.harness = {
  ...{ camera, width, height, quarters, object },
  viewEvents: [],
  /** Creates a view in a host of that size. */
  async start(hostWidth, hostHeight, forceWebGL) {
    const host = document.createElement("div");
    host.id = "host";
    host.style.cssText = `width:${hostWidth}px;height:${hostHeight}px;background:rgb(250, 251, 252)`;
    document.body.style.margin = "0";
    document.body.replaceChildren(host);
    const { viewEvents } = harness;
    const events = {
      onPose: (id, pose, phase) => viewEvents.push({ kind: "pose", id, pose: Array.from(pose), phase }),
      onSelect: (id) => viewEvents.push({ kind: "select", id }),
      onHover: (pixel) => viewEvents.push({ kind: "hover", pixel }),
    };
    harness.view = await SceneView.create(host, events, forceWebGL);
    return harness.view.backend;
  },
  /** Shows the wall from the camera. */
  show(display = {}) {
    harness.view.setDisplay({ cloud: true, mesh: true, wireframe: false, pointSize: 1, theme: "light", ...display });
    harness.view.setScene(scene());
    harness.view.lookFrom("camera");
  },
  /** The colours at positions in the view, CSS pixels. */
  async colours(places) {
    const { clientWidth, clientHeight } = document.querySelector("#host");
    const bitmap = await createImageBitmap(await harness.view.picture(clientWidth, clientHeight, false));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const ratio = bitmap.width / clientWidth;
    const at = ([x, y]) => [
      ...context.getImageData(Math.floor(x * ratio), Math.floor(y * ratio), 1, 1).data.slice(0, 3),
    ];
    return places.map(at);
  },
};
