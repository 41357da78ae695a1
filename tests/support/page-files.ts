/** Files that the tests of the page drop on it: a case, several ones, a video, and cases of which one file is wrong or odd. */
import assert from "node:assert/strict";
import { zipSync } from "fflate";
import { maskPng as maskFile, npy, obj, png } from "./files.js";
import { cuboid, mesh, type Pose, pinhole, render, transformed, truth, view } from "./scene.js";
import type { SitePage } from "./site.js";

/** Files by name. */
export type Files = Record<string, Uint8Array>;

/** The view of the object, and the size of all images. */
export const seen = view;
export const { width: WIDTH, height: HEIGHT } = view;

/** A JSON file. */
export const jsonFile = (content: unknown) => Buffer.from(JSON.stringify(content));

export const cameraFile = jsonFile({ ...pinhole, width: WIDTH, height: HEIGHT });

/** A depth map, metres. */
export const depthNpy = (depth: Float32Array) => npy(depth, HEIGHT, WIDTH);

/** A mask as a PNG of 0 and 255. */
export const maskPng = (mask: Uint8Array) => maskFile(mask, WIDTH, HEIGHT);

/** A complete case of one object. */
export const files: Files = {
  "depth.npy": depthNpy(seen.depth),
  "mask.png": maskPng(seen.mask),
  "camera.json": cameraFile,
  "mesh.obj": obj(mesh),
};

/** The files, in a folder. */
export const inFolder = (folder: string, content: Files): Files =>
  Object.fromEntries(Object.entries(content).map(([name, bytes]) => [`${folder}/${name}`, bytes]));

/** The complete case with another depth map, mask or mesh. */
const changed = (more: Files): Files => ({ ...files, ...more });

/** The same scene, farther away: another depth map. */
export const farther = (byM: number): Files => changed({ "depth.npy": depthNpy(seen.depth.map((z) => z + byM)) });

/** Four scenes, each in a folder of its own. */
export const four: Files = Object.assign({}, ...[1, 2, 3, 4].map((i) => inFolder(`IMG_00${i}`, farther(0.01 * i))));

/** The sides of a box of sugar, metres. */
export const SIDES_M = [0.045, 0.092, 0.176] as const;

/** That box, in a file whose axes are tilted against its sides, in another unit, as generated meshes are. */
export function tiltedBox(): Files {
  const box = cuboid(SIDES_M[0] / 2, SIDES_M[1] / 2, SIDES_M[2] / 2);
  const tilt = { ...truth, scale: 7, rotation: [0.42, 0.36, -0.18, 0.814], translation: [1, 2, 3] } satisfies Pose;
  const view = render(box, { ...truth, scale: 1 }, pinhole, WIDTH, HEIGHT);
  return changed({
    "depth.npy": depthNpy(view.depth),
    "mask.png": maskPng(view.mask),
    "mesh.obj": obj({ positions: Float32Array.from(transformed(box.positions, tilt)), indices: box.indices }),
  });
}

/** Depth in another unit than millimetres, as some datasets have it. */
export function depthInUnits(perMetre: number): Files {
  const depth = png(
    Uint16Array.from(seen.depth, (z) => Math.round(perMetre * z)),
    WIDTH,
    HEIGHT,
  );
  const { "depth.npy": _, ...rest } = files;
  return { ...rest, "depth.png": depth };
}

/** The intrinsics are those of an image of twice the size, or of another one. */
export function otherCamera(width: number, height: number): Files {
  const scaled = { fx: 2 * pinhole.fx, fy: 2 * pinhole.fy, cx: 2 * pinhole.cx + 0.5, cy: 2 * pinhole.cy + 0.5 };
  return changed({ "camera.json": jsonFile({ ...scaled, width, height }) });
}

/** The intrinsics of an image of half the size, which does not say so. */
export const halfCamera = jsonFile({
  ...{ fx: pinhole.fx / 2, fy: pinhole.fy / 2 },
  ...{ cx: (pinhole.cx + 0.5) / 2 - 0.5, cy: (pinhole.cy + 0.5) / 2 - 0.5 },
});

/** A picture of the depth in 256 grey levels: 0 has no reading, and near is dark. */
export const nearIsDark: Files = (() => {
  const { "depth.npy": _, ...rest } = files;
  const readings = [...seen.depth].filter((z) => z > 0);
  const [near, far] = [Math.min(...readings), Math.max(...readings)];
  const grey = Uint8Array.from(seen.depth, (z) => (z > 0 ? Math.round(1 + (254 * (z - near)) / (far - near)) : 0));
  return { ...rest, "depth.png": png(grey, WIDTH, HEIGHT) };
})();

/** The number of frames of the video. */
export const COUNT = 5;

/** The pose in a frame: the object moves aside, 2 % of its distance from frame to frame. */
export function poseIn(frame: number): Pose {
  const [x, y, z] = truth.translation;
  return { ...truth, translation: [x + 0.02 * z * (frame - (COUNT - 1) / 2), y, z] };
}

/** The pose of a camera that has moved along x, as a file. */
export function cameraAt(x: number): Uint8Array {
  const rows = [
    [1, 0, 0, x],
    [0, 1, 0, 0],
    [0, 0, 1, 0],
    [0, 0, 0, 1],
  ];
  return jsonFile({ camera_to_world: rows });
}

/** A video: the folders of its frames. */
export function frames(hasMasks: boolean): Files {
  const files: Files = { "toy/mesh.obj": obj(mesh) };
  for (let i = 0; i < COUNT; i++) {
    const seen = render(mesh, poseIn(i), pinhole, WIDTH, HEIGHT);
    const folder = `toy/frame_0${i}/`;
    files[`${folder}depth.npy`] = depthNpy(seen.depth);
    files[`${folder}camera.json`] = cameraFile;
    // The camera moves along; the world is that of the first frame.
    files[`${folder}pose.json`] = cameraAt(0.01 * i);
    if (hasMasks || i === 0) files[`${folder}mask.png`] = maskPng(seen.mask);
  }
  return files;
}

/** Drops files on the page. */
export async function drop({ page }: SitePage, dropped: Files): Promise<void> {
  const encoded = Object.entries(dropped).map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]);
  const data = await page.evaluateHandle((parts) => {
    const transfer = new DataTransfer();
    for (const [name = "", base64 = ""] of parts) {
      const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      transfer.items.add(new File([bytes], name));
    }
    return transfer;
  }, encoded);
  await page.dispatchEvent("body", "dragenter", { dataTransfer: data });
  assert.ok(await page.isVisible(".drop-here"));
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
}

/** Drops a folder as a zip archive. */
export const dropFolder = (opened: SitePage, dropped: Files) =>
  drop(opened, { "folder.zip": Buffer.from(zipSync(dropped)) });

/** Chooses a file for a field of the intake sheet. */
export const choose = ({ page }: SitePage, field: string, name: string, bytes: Uint8Array) =>
  page.setInputFiles(`#${field}-file`, { name, mimeType: "", buffer: Buffer.from(bytes) });
